//! Scratch: runs a deck and prints rows.
use wythe_core::{model::{Deck, Model}, results::*, solve};
struct P(std::time::Instant);
impl Recorder for P {
    fn take(&mut self, _m: &Model, r: &HistoryRow, _f: Option<&Frame>) -> std::io::Result<bool> {
        let bal = r.external_work_J - r.elastic_energy_J - r.plastic_damage_dissipation_J - r.interface_dissipation_J - r.viscous_dissipation_J;
        println!("{:4} s{} t={:.4} u={:.4} F={:.3} R={:.2} it={} cut={} W={:.3} el={:.3} pd={:.3} if={:.3} v={:.3} bal={:.4} open={} slip={} D={:.3} dt={:.3} dc={:.3} oob={:.3} [{:.1}s]",
          r.increment, r.step, r.time, r.displacement_mm, r.force_kN, r.reaction_kN, r.iterations, r.cutbacks, r.external_work_J, r.elastic_energy_J, r.plastic_damage_dissipation_J, r.interface_dissipation_J, r.viscous_dissipation_J, bal, r.open_points, r.sliding_points, r.max_interface_damage, r.max_tensile_damage, r.max_compressive_damage, r.out_of_balance, self.0.elapsed().as_secs_f64());
        Ok(true)
    }
}
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let sets: Vec<(String, String)> = a[2..].iter().map(|s| { let (k, v) = s.split_once('=').unwrap(); (k.into(), v.into()) }).collect();
    let deck = Deck::load(&a[1], &sets).map_err(|e| eprintln!("{e:?}")).unwrap();
    let (model, w) = Model::from_deck(&deck).map_err(|e| eprintln!("{e:?}")).unwrap();
    for w in w { println!("{w:?}"); }
    let s = solve::run(&model, &mut P(std::time::Instant::now()));
    println!("{s:#?}");
}
