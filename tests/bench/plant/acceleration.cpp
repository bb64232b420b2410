#include "tests/bench/plant/acceleration.hpp"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <functional>
#include <variant>

#include "tests/bench/plant/figure.hpp"

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

double nanoseconds_of_pass(Peer& subject, std::size_t samples) {
  // Once for caches and branches, which whoever came before has left otherwise.
  for (std::size_t i = 0; i < samples; ++i) subject.evaluate(i);
  const auto start = std::chrono::steady_clock::now();
  for (std::size_t i = 0; i < samples; ++i) subject.evaluate(i);
  const std::chrono::duration<double, std::nano> taken = std::chrono::steady_clock::now() - start;
  return taken.count() / static_cast<double>(samples);
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

void add_peers(const Rig& rig, Contest& all) {
  if (std::holds_alternative<model::GyroscopeParameters>(rig.machine)) return;  // it has none
  std::vector<Sample> states = random_samples(rig, 200);
  states.insert(states.end(), all.samples.begin(), all.samples.end());
  using Make = std::unique_ptr<Peer> (*)(const Rig&);
  for (const Make make : {&mujoco_peer, &mujoco_projected_peer, &dart_peer, &simbody_peer}) {
    std::unique_ptr<Peer> peer = make(rig);
    const double apart = disagreement(*peer, *all.subjects.front(), states);
    print_figure("acceleration", rig.name, peer->name(), "disagreement", "1", apart);
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

Contest contest(const std::string& name) {
  const Rig rig = load_rig(name);
  Contest all{name, trajectory(rig), {}};
  all.subjects.push_back(gyrotwin_peer(rig));
  if (rig.rotor_drive) all.subjects.push_back(gyrotwin_with_rotor_drives(rig));
  add_peers(rig, all);
  for (auto& subject : all.subjects) subject->load(all.samples);
  return all;
}

void time_accelerations(Contest& contest, double seconds) {
  std::vector<std::vector<double>> passes(contest.subjects.size());
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
  while (std::chrono::steady_clock::now() < end) {
    for (std::size_t s = 0; s < passes.size(); ++s) {
      passes[s].push_back(nanoseconds_of_pass(*contest.subjects[s], contest.samples.size()));
    }
  }
  for (std::size_t s = 0; s < passes.size(); ++s) {
    print_figure("acceleration", contest.rig, contest.subjects[s]->name(), "p50", "ns",
                 median(std::move(passes[s])));
  }
}

}  // namespace gyrotwin::bench
