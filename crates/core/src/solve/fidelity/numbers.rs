//! Numbers of nodes and elements in what is told of a run.

use crate::model::mirrored::Half;

/// What nodes and elements of the model that is solved are called in the one that is shown; their own numbers, if the
/// model itself is solved.
#[derive(Clone, Debug, Default)]
pub(in crate::solve) struct Numbers {
    node: Option<Vec<u32>>,
    element: Option<Vec<u32>>,
}

impl Numbers {
    /// Of a half in its whole.
    pub fn of(half: &Half) -> Self {
        Self {
            node: Some(kept(&half.node)),
            element: Some(kept(&half.element)),
        }
    }

    /// Of a half whose whole is itself a half of what is shown.
    pub fn of_whole(&self, whole: &Self) -> Self {
        let of = |own: &Option<Vec<u32>>, name: &dyn Fn(usize) -> usize| {
            let own = own.as_ref()?.iter();
            Some(own.map(|n| name(*n as usize) as u32).collect())
        };
        Self {
            node: of(&self.node, &|n| whole.node(n)),
            element: of(&self.element, &|e| whole.element(e)),
        }
    }

    /// What a node is called.
    pub fn node(&self, n: usize) -> usize {
        self.node.as_ref().map_or(n, |node| node[n] as usize)
    }

    /// What an element is called.
    pub fn element(&self, e: usize) -> usize {
        self.element
            .as_ref()
            .map_or(e, |element| element[e] as usize)
    }
}

/// What is kept, in order.
fn kept(number: &[Option<u32>]) -> Vec<u32> {
    let all = number.iter().enumerate();
    all.filter_map(|(i, own)| own.map(|_| i as u32)).collect()
}
