#include "tests/bench/plant/acceleration.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <variant>

#include "tests/bench/figure.hpp"

namespace gyrotwin::bench {

namespace {

/// Largest difference of one subject from the model over the samples, relative to the largest
/// acceleration at that sample.
double disagreement(Peer& peer, Peer& model, const std::vector<Sample>& samples) {
  peer.load(samples);
  model.load(samples);
  double worst = 0.0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    peer.evaluate(i);
    model.evaluate(i);
    const model::Coordinates expected = model.acceleration();
    const double error =
        (peer.acceleration() - expected).cwiseAbs().maxCoeff() / expected.cwiseAbs().maxCoeff();
    worst = std::isfinite(error) ? std::max(worst, error) : HUGE_VAL;
  }
  return worst;
}

void add_peers(const Rig& rig, Contest& all) {
  if (std::holds_alternative<model::GyroscopeParameters>(rig.machine)) return;  // it has none
  std::vector<Sample> states = random_samples(rig, 200);
  states.insert(states.end(), all.samples.begin(), all.samples.end());
  using Make = std::unique_ptr<Peer> (*)(const Rig&);
  for (const Make make : {&mujoco_peer, &mujoco_projected_peer, &dart_peer, &simbody_peer}) {
    std::unique_ptr<Peer> peer = make(rig);
    const double apart = disagreement(*peer, *all.subjects.front(), states);
    Figure{"acceleration", rig.name, peer->name()}.print("disagreement", "1", apart);
    if (apart > kAgreement) {
      std::fprintf(stderr, "%s: %s is left out: its accelerations differ by %.1e\n",
                   rig.name.c_str(), peer->name().c_str(), apart);
      continue;
    }
    all.subjects.push_back(std::move(peer));
  }
}

}  // namespace

const std::vector<std::string>& contest_rigs() {
  static const std::vector<std::string> rigs{"prototype_b",    "prototype_b_sleeping",
                                             "double_brennan", "brennan_monorail",
                                             "gyrocar",        "simple_gyroscope"};
  return rigs;
}

Contest contest(const std::string& name, bool peers) {
  const Rig rig = load_rig(name);
  Contest all{name, trajectory(rig), {}};
  all.subjects.push_back(gyrotwin_peer(rig));
  if (rig.rotor_drive) all.subjects.push_back(gyrotwin_with_rotor_drives(rig));
  if (peers) add_peers(rig, all);
  for (auto& subject : all.subjects) subject->load(all.samples);
  return all;
}

Turn turn_of(Peer& subject) {
  return [&subject](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) subject.evaluate(i);
  };
}

void time_accelerations(Contest& contest, double seconds) {
  std::vector<Turn> turns;
  for (const auto& subject : contest.subjects) turns.push_back(turn_of(*subject));
  const std::vector<double> medians = medians_in_turns(turns, contest.samples.size(), seconds);
  for (std::size_t s = 0; s < medians.size(); ++s) {
    Figure{"acceleration", contest.rig, contest.subjects[s]->name()}.print("p50", "ns", medians[s]);
  }
}

}  // namespace gyrotwin::bench
