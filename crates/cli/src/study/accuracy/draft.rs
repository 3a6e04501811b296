//! Draft of a `scene.toml` for a model, with the choices that its user has.

use std::path::Path;

use miette::Diagnostic;
use thiserror::Error;

use super::offered::{offered, refined, scaled};
use super::scene::{Choice, Group};
use super::written::{ChoiceFile, ReferenceFile, SceneFile};
use wythe_core::deck::Deck;
use wythe_core::deck::schema::{DeckProbe, DeckStep, StepKind};

/// Uncertainty of a reference by refinement, relative to its peak [-]: the part that `fidelity = "auto"` may
/// neglect. The effect of a still finer mesh is estimated from the choices that share only its mesh or only its
/// increments.
const UNCERTAINTY: f64 = 0.005;

/// Reason why a model has no scene.
#[derive(Debug, Error, Diagnostic)]
pub enum DraftError {
    /// No curve of the last step advances in one direction.
    #[error("no curve of this model can be compared: {0}")]
    #[diagnostic(help(
        "the last step must drive along an axis, one way only, or steer its load by a displacement; of other models a scene.toml of your own names the columns (docs/reference/studies.md)"
    ))]
    NoCurve(&'static str),
    /// The text cannot be written.
    #[error("the scene cannot be written: {0}")]
    Text(#[from] toml::ser::Error),
}

/// Compared columns as a scene names them, and the end of the comparison.
struct Compared {
    x: String,
    y: String,
    to: f64,
}

/// Writes the `scene.toml` in `folder` for the model in `file` with the overrides `set`. The scene compares the
/// last step over all choices that a user has. Its reference has a finer mesh and half the increments, and is
/// computed on `threads` threads, those of the machine.
///
/// # Errors
/// [`DraftError::NoCurve`]: the last step has no curve that advances in one direction.
pub fn draft(
    deck: &Deck,
    file: &Path,
    folder: &Path,
    set: &[(String, String)],
    threads: usize,
) -> Result<String, DraftError> {
    let last = deck.steps.len().checked_sub(1);
    let last = last.ok_or(DraftError::NoCurve("it has no steps"))?;
    let compared = compared(deck, last)?;
    let refined = refined(deck);
    let how = if refined.is_empty() {
        "half the increments; its mesh is that of the model, which no key refines."
    } else {
        "elements of half the size along every side (a layer of mortar stays one), half the increments."
    };
    let reference = [refined, scaled(deck, last, 0.5)].concat();
    let choices = choices(deck, file, set, threads)?;
    // A relative path stays valid if both files are moved together. There is none from one drive to another.
    let way = pathdiff::diff_paths(file, folder).unwrap_or_else(|| file.to_owned());
    let name = file.file_stem().unwrap_or_default().to_string_lossy();
    let draft = SceneFile {
        number: 1,
        title: if deck.title.is_empty() {
            name.to_string()
        } else {
            deck.title.clone()
        },
        what: format!(
            "`{name}.toml`, its step `{}`, over what may be chosen.",
            deck.steps[last].name()
        ),
        says: String::new(),
        deck: way.to_string_lossy().replace('\\', "/"),
        set: lines(set),
        short: None,
        x: compared.x,
        y: compared.y,
        steps: Some(vec![last]),
        from: None,
        to: compared.to,
        short_to: None,
        reference: ReferenceFile {
            file: "reference.csv".to_owned(),
            x: None,
            y: None,
            y_factor: 1.0,
            peak: None,
            how: how.to_owned(),
            uncertainty: UNCERTAINTY,
            set: Some(lines(&reference)),
            threads,
            factor: None,
            command: None,
        },
        choices,
        peers: Vec::new(),
    };
    let text = toml::to_string(&draft)?;
    Ok(format!(
        "# A scene for `wythe study accuracy-speed`, drafted from the model; docs/reference/studies.md lists the keys. It stays as you change it.\n{text}"
    ))
}

/// The default and all alternatives. Choices that the deck rejects or already contains are left out.
fn choices(
    deck: &Deck,
    file: &Path,
    set: &[(String, String)],
    threads: usize,
) -> Result<Vec<ChoiceFile>, DraftError> {
    let was = deck.to_toml()?;
    let chooses = |choice: &Choice| {
        let all = [set, &choice.set].concat();
        let with = Deck::load(file, &all)
            .ok()
            .and_then(|deck| deck.to_toml().ok());
        with.is_some_and(|with| with != was || choice.group == Group::Threads)
    };
    let default = Choice::new("default", Group::Default, Vec::new());
    let offered = offered(deck, deck.steps.len().saturating_sub(1)).into_iter();
    let offered = offered.filter(|choice| choice.threads <= threads && chooses(choice));
    let written = |choice: Choice| ChoiceFile {
        set: lines(&choice.set),
        name: choice.name,
        group: choice.group,
        threads: choice.threads,
        factor: choice.factor,
        short: choice.short,
    };
    Ok(std::iter::once(default)
        .chain(offered)
        .map(written)
        .collect())
}

/// Keys and values in the form of `--set`.
fn lines(set: &[(String, String)]) -> Vec<String> {
    set.iter().map(|(k, v)| format!("{k}={v}")).collect()
}

/// Columns and range that describe the last step.
fn compared(deck: &Deck, last: usize) -> Result<Compared, DraftError> {
    let step = &deck.steps[last];
    if let Some(control) = &step.control {
        let of = |probe: &&DeckProbe| probe.name == control.probe;
        let probe = deck.probes.iter().find(of).map(DeckProbe::column);
        let x = probe.ok_or(DraftError::NoCurve("it has not the probe that steers it"))?;
        // The last increment may end within a thousandth of the target.
        let to = 0.995 * control.displacement.get();
        return along(&x, "load_factor", [0.0, to], 1.0);
    }
    let is_drive = |step: &&DeckStep| step.kind == StepKind::Drive;
    if !is_drive(&step) {
        return Err(DraftError::NoCurve(
            "its last step neither drives nor steers its load by a displacement",
        ));
    }
    let drives = deck.steps.iter().filter(is_drive);
    let mut way = [0.0; 2];
    for drive in drives {
        if drive.cycles.is_some() || drive.direction != step.direction {
            return Err(DraftError::NoCurve("it is driven to and fro"));
        }
        let sign = drive.direction.map_or(1.0, |direction| {
            let along = direction.unit();
            along
                .into_iter()
                .find(|part| *part != 0.0)
                .map_or(1.0, f64::signum)
        });
        way = [way[1], way[1] + sign * drive.drive()];
    }
    // The history counts displacement and force along the drive.
    let sense = way[1].signum();
    along("displacement_mm", "force_kN", way.map(|x| sense * x), 1.0)
}

/// A curve of `y` times `of_y` along `x`; the sign of `x` is changed if `x` decreases.
fn along(x: &str, y: &str, way: [f64; 2], of_y: f64) -> Result<Compared, DraftError> {
    let of_x = way[1].signum();
    let [from, to] = way.map(|x| of_x * x);
    if from >= 0.0 && to > from {
        let signed = |column: &str, sign: f64| {
            let minus = if sign < 0.0 { "-" } else { "" };
            format!("{minus}{column}")
        };
        Ok(Compared {
            x: signed(x, of_x),
            y: signed(y, of_y),
            to,
        })
    } else {
        Err(DraftError::NoCurve("its displacement goes forth and back"))
    }
}

#[cfg(test)]
mod tests {
    use std::path::PathBuf;

    use super::super::scene::{Origin, Scene};
    use super::*;

    fn example(name: &str) -> PathBuf {
        Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("../../examples/{name}.toml"))
    }

    fn drafted(name: &str, set: &[(&str, &str)]) -> Result<Scene, DraftError> {
        let set: Vec<_> = set
            .iter()
            .map(|(k, v)| ((*k).to_owned(), (*v).to_owned()))
            .collect();
        let file = example(name);
        let deck = Deck::load(&file, &set).unwrap();
        let folder = Path::new(env!("CARGO_MANIFEST_DIR"));
        let text = draft(&deck, &file, folder, &set, 2)?;
        // The written text must be readable.
        let scene = Scene::from_str(&text, "scene.toml", folder).unwrap();
        assert!(text.contains("deck = \"../../examples/"), "{text}");
        Ok(scene)
    }

    fn keys(scene: &Scene, name: &str) -> Option<String> {
        let choice = scene.choices.iter().find(|c| c.name == name)?;
        Some(lines(&choice.set).join(" "))
    }

    #[test]
    fn a_pushed_wall_is_compared_along_its_drive() {
        let scene = drafted("03_shear_wall_j7d", &[("steps.1.displacement", "0.8 mm")]).unwrap();
        assert_eq!(
            (scene.x.as_str(), scene.y.as_str()),
            ("displacement_mm", "force_kN")
        );
        assert_eq!(
            (scene.range, scene.steps.as_deref()),
            ([0.0, 0.8], Some(&[1][..]))
        );
        let Origin::Run(reference) = &scene.reference.origin else {
            panic!("{:?}", scene.reference.origin)
        };
        assert_eq!(
            lines(&reference.set),
            [
                "wall.mesh=[9,3,4]",
                "steps.1.increments.initial=0.0025",
                "steps.1.increments.max=0.00625"
            ]
        );
        assert_eq!(
            keys(&scene, "mesh coarser").as_deref(),
            Some("wall.mesh=[3,2,1]")
        );
        assert_eq!(
            keys(&scene, "volume").as_deref(),
            Some("materials.brick.crack_band=volume materials.mortar.crack_band=volume")
        );
        // A setting that the deck already contains is no choice, nor is one that it does not have.
        assert_eq!(keys(&scene, "projected"), None);
        assert_eq!(keys(&scene, "penalty 50"), None);
        assert_eq!(keys(&scene, "joints x 4"), None);
        assert!(keys(&scene, "penalty 500").is_some());
        assert_eq!(keys(&scene, "2 threads").as_deref(), Some(""));
        assert_eq!(keys(&scene, "4 threads"), None);
    }

    #[test]
    fn a_steered_load_is_compared_along_what_steers_it() {
        let scene = drafted("62_out_of_plane_wall", &[]).unwrap();
        assert_eq!(
            (scene.x.as_str(), scene.y.as_str()),
            ("middle_mm", "load_factor")
        );
        assert_eq!(scene.range, [0.0, 9.95]);
        // The wall is bent: three elements through its thickness.
        assert_eq!(
            keys(&scene, "mesh finer through the thickness").as_deref(),
            Some("wall.mesh=[5,2,6]")
        );
        assert_eq!(keys(&scene, "penalty 50"), None);
        assert!(keys(&scene, "penalty 500").is_some());
        assert_eq!(keys(&scene, "implex"), None);
    }

    #[test]
    fn stiffness_that_is_said_is_a_choice() {
        let scene = drafted("../docs/validation/05-arches/sideways-27-12", &[]).unwrap();
        assert_eq!(
            keys(&scene, "joints x 4").as_deref(),
            Some("interfaces.dry.normal_stiffness=400 interfaces.dry.shear_stiffness=400")
        );
        assert_eq!(keys(&scene, "penalty 50"), None);
        assert_eq!(keys(&scene, "volume"), None);
    }

    /// Drives along -x are counted along the drive. For a probe that falls, the sign is changed, and its load
    /// still grows.
    #[test]
    fn curves_go_along_the_drive() {
        let signs = |name: &str, set: &[(&str, &str)]| {
            let scene = drafted(name, set).unwrap();
            assert!(scene.range[1] > 0.0, "{:?}", scene.range);
            scene.signs
        };
        let (push, press) = ("03_shear_wall_j7d", "62_out_of_plane_wall");
        assert_eq!(signs(push, &[("steps.1.direction", "-x")]), [1.0, 1.0]);
        assert_eq!(
            signs(push, &[("steps.1.displacement", "-1 mm")]),
            [1.0, 1.0]
        );
        let pulled = [
            ("steps.1.control.displacement", "-1 mm"),
            ("steps.1.loads.0.pressure", "-10 kPa"),
        ];
        assert_eq!(signs(press, &pulled), [-1.0, 1.0]);
        assert_eq!(signs(press, &[]), [1.0, 1.0]);
    }

    #[test]
    fn what_goes_no_way_has_no_curve() {
        for (name, set) in [("42_cyclic_wall", &[][..]), ("30_toppling_stack", &[])] {
            let told = drafted(name, set).unwrap_err();
            assert!(matches!(told, DraftError::NoCurve(_)), "{name}: {told}");
        }
    }
}
