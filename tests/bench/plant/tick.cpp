#include "tests/bench/plant/tick.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "services/integrator/plant.hpp"
#include "services/runtime/error.hpp"
#include "tests/bench/figure.hpp"

namespace gyrotwin::bench {

namespace {

class Gyrotwin : public Ticker {
 public:
  Gyrotwin(const Rig& rig, std::string name, const StepPolicy& policy)
      : name_(std::move(name)),
        machine_(rig.build_machine()),
        plant_(machine_, rig.loop.tick_s(), policy) {}

  std::string name() const override { return name_; }
  void start(const model::State& state) override { plant_.set_state(state); }
  void tick(const model::Input& input) override {
    if (!plant_.advance(input)) throw Error("the plant's solver failed");
  }
  model::Coordinates coordinates() const override { return plant_.state().q; }

 private:
  std::string name_;
  model::Machine machine_;
  Plant plant_;
};

/// What everybody goes through.
struct Scenario {
  explicit Scenario(const Rig& rig) {
    const model::Machine machine = rig.build_machine();
    start = machine.state(rig.initial_q, rig.initial_v);
    const int ticks = static_cast<int>(std::lround(kSteppingDuration / rig.loop.tick_s()));
    for (int k = 0; k < ticks; ++k) inputs.push_back(scenario_input(rig, machine, k));
  }
  model::State start;
  std::vector<model::Input> inputs;
};

/// Largest difference of any coordinate at any tick [rad].
double error(const Scenario& scenario, Ticker& ticker, Ticker& reference) {
  double worst = 0.0;
  ticker.start(scenario.start);
  reference.start(scenario.start);
  for (const model::Input& input : scenario.inputs) {
    ticker.tick(input);
    reference.tick(input);
    const model::Coordinates apart = ticker.coordinates() - reference.coordinates();
    if (!apart.allFinite()) return HUGE_VAL;
    worst = std::max(worst, apart.cwiseAbs().maxCoeff());
  }
  return worst;
}

void time_ticks(const Scenario& scenario, Ticker& ticker, std::vector<double>& nanoseconds) {
  using Clock = std::chrono::steady_clock;
  ticker.start(scenario.start);
  for (const model::Input& input : scenario.inputs) {
    const Clock::time_point begin = Clock::now();
    ticker.tick(input);
    nanoseconds.push_back(std::chrono::duration<double, std::nano>(Clock::now() - begin).count());
  }
}

}  // namespace

std::unique_ptr<Ticker> gyrotwin_ticker(const Rig& rig, std::optional<int> steps_per_ms) {
  if (!steps_per_ms) {
    return std::make_unique<Gyrotwin>(rig, "gyrotwin", StepPolicy{.substeps = rig.loop.substeps});
  }
  const int substeps = *steps_per_ms * static_cast<int>(std::lround(1e3 * rig.loop.tick_s()));
  return std::make_unique<Gyrotwin>(rig, "gyrotwin " + std::to_string(*steps_per_ms) + " steps",
                                    StepPolicy{.substeps = substeps});
}

std::unique_ptr<Ticker> gyrotwin_reference(const Rig& rig) {
  return std::make_unique<Gyrotwin>(rig, "gyrotwin reference",
                                    StepPolicy{StepPolicy::Kind::kAdaptive});
}

const std::vector<std::string>& tick_rigs() {
  static const std::vector<std::string> rigs{"prototype_b", "prototype_b_sleeping",
                                             "double_brennan"};
  return rigs;
}

void measure_ticks(const std::string& name, double seconds) {
  constexpr int kReferenceSteps = 128;  // in a millisecond
  const Rig rig = load_rig(name);
  const Scenario scenario(rig);

  std::vector<std::unique_ptr<Ticker>> tickers;
  const auto add = [&](std::unique_ptr<Ticker> ticker, Ticker& reference) {
    Figure{"tick", name, ticker->name()}.print("error", "rad", error(scenario, *ticker, reference));
    tickers.push_back(std::move(ticker));
  };
  const std::unique_ptr<Ticker> own_reference = gyrotwin_reference(rig);
  add(gyrotwin_ticker(rig), *own_reference);
  add(gyrotwin_ticker(rig, 2), *own_reference);
  for (const auto make : {&mujoco_ticker, &mujoco_projected_ticker}) {
    const std::unique_ptr<Ticker> reference = make(rig, kReferenceSteps);
    for (const int steps : {1, 4}) add(make(rig, steps), *reference);
  }

  std::vector<std::vector<double>> times(tickers.size());
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
  while (std::chrono::steady_clock::now() < end) {
    for (std::size_t i = 0; i < tickers.size(); ++i) time_ticks(scenario, *tickers[i], times[i]);
  }
  for (std::size_t i = 0; i < tickers.size(); ++i) {
    std::sort(times[i].begin(), times[i].end());
    const auto last = static_cast<double>(times[i].size() - 1);
    const auto at = [&](double share) { return times[i][static_cast<std::size_t>(share * last)]; };
    Figure{"tick", name, tickers[i]->name()}.print("p50", "ns", at(0.5));
    Figure{"tick", name, tickers[i]->name()}.print("p99", "ns", at(0.99));
    Figure{"tick", name, tickers[i]->name()}.print("max", "ns", at(1.0));
  }
}

}  // namespace gyrotwin::bench
