#include "clients/calibrate/fit.hpp"

#include <ceres/ceres.h>
#include <glog/logging.h>
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>

#include "services/runtime/error.hpp"

namespace gyrotwin::calibration {

namespace {

constexpr double kGoodEnough =
    1.5;  // reduced chi^2 up to which deviations are believed as they are
// Relative change of the cost that ends the searches: of states alone, and of everything.
constexpr double kRoughly = 1e-4, kTolerance = 1e-6;
// A first round of the search believes the rig file that much: what the data tell well comes right
// before what they hardly tell can run away.
constexpr double kFirstBelief = 0.05;

/// The unknowns, where Ceres finds them: parameters, biases, a start a segment.
struct Unknowns {
  std::vector<double> x, bias;
  std::vector<std::vector<double>> starts;
};

/// Makes the machines of a point once, before all segments are shot at it.
class Machines : public ceres::EvaluationCallback {
 public:
  Machines(const Family& family, const Unknowns& unknowns) : family_(family), unknowns_(unknowns) {}

  void PrepareForEvaluation(bool jacobians, bool new_point) override {
    if (!new_point && around_ && (has_pairs_ || !jacobians || !free)) return;
    around_.reset();
    has_pairs_ = jacobians && free;
    try {
      around_ = has_pairs_ ? family_.around(unknowns_.x)
                           : Neighbourhood{family_.machine_at(unknowns_.x), {}};
    } catch (const Error&) {
      // No such rig: a step too far, which Ceres takes back.
    }
  }
  const Neighbourhood* around() const { return around_ ? &*around_ : nullptr; }

  bool free = false;  ///< derivatives by parameters are wanted

 private:
  const Family& family_;
  const Unknowns& unknowns_;
  std::optional<Neighbourhood> around_;
  bool has_pairs_ = false;
};

/// Residuals of one segment. Blocks: start, [next start,] parameters, biases.
class SegmentCost : public ceres::CostFunction {
 public:
  SegmentCost(const Segment& segment, const Machines& machines, const Rig::Sensors& sensors,
              int parameters, int biases)
      : segment_(segment),
        machines_(machines),
        sensors_(sensors),
        parameters_(parameters),
        biases_(biases) {
    set_num_residuals(static_cast<int>(segment.size()));
    const int n = static_cast<int>(segment.start.size());
    mutable_parameter_block_sizes()->push_back(n);
    if (segment.continued) mutable_parameter_block_sizes()->push_back(n);
    mutable_parameter_block_sizes()->push_back(parameters);
    if (biases > 0) mutable_parameter_block_sizes()->push_back(biases);
  }

  bool Evaluate(double const* const* blocks, double* residuals, double** jacobians) const override {
    const Neighbourhood* around = machines_.around();
    if (around == nullptr) return false;
    const auto n = static_cast<std::size_t>(segment_.start.size());
    const int after = segment_.continued ? 2 : 1;
    const std::span<const double> next(blocks[1], segment_.continued ? n : 0);
    const double* bias = biases_ > 0 ? blocks[after + 1] : nullptr;
    Shot shot;
    if (!shoot(segment_, *around, sensors_, {blocks[0], n}, next,
               {bias, static_cast<std::size_t>(biases_)}, jacobians != nullptr, shot)) {
      return false;
    }
    std::copy_n(shot.residual.data(), shot.residual.size(), residuals);
    if (jacobians == nullptr) return true;
    if (jacobians[0]) std::copy_n(shot.by_start.data(), shot.by_start.size(), jacobians[0]);
    if (segment_.continued && jacobians[1]) write_seam(around->machine.coordinates(), jacobians[1]);
    if (jacobians[after]) {
      if (shot.by_parameter.cols() != parameters_) return false;
      std::copy_n(shot.by_parameter.data(), shot.by_parameter.size(), jacobians[after]);
    }
    if (biases_ > 0 && jacobians[after + 1]) write_biases(jacobians[after + 1]);
    return true;
  }

 private:
  void write_seam(int coordinates, double* to) const {
    const Eigen::Index n = segment_.start.size();
    Eigen::Map<Shot::Rows> by_next(to, segment_.size(), n);
    by_next.setZero();
    for (Eigen::Index i = 0; i < n; ++i) {
      by_next(segment_.size() - n + i, i) = -1.0 / seam_sigma(i, coordinates);
    }
  }

  void write_biases(double* to) const {
    Eigen::Map<Shot::Rows> by_bias(to, segment_.size(), biases_);
    by_bias.setZero();
    for (std::size_t i = 0; i < segment_.rows.size(); ++i) {
      const Row& row = segment_.rows[i];
      if (row.bias >= 0) by_bias(static_cast<Eigen::Index>(i), row.bias) = 1.0 / row.sigma;
    }
  }

  const Segment& segment_;
  const Machines& machines_;
  const Rig::Sensors& sensors_;
  int parameters_, biases_;
};

/// What is believed beforehand: (value - mean_i) / sigma_i.
class Belief : public ceres::CostFunction {
 public:
  /// @param sigma outlives it, and may change between searches
  Belief(std::vector<double> mean, const std::vector<double>& sigma)
      : mean_(std::move(mean)), sigma_(sigma) {
    set_num_residuals(static_cast<int>(mean_.size()));
    mutable_parameter_block_sizes()->push_back(static_cast<int>(mean_.size()));
  }

  bool Evaluate(double const* const* blocks, double* residuals, double** jacobians) const override {
    const std::size_t n = mean_.size();
    for (std::size_t i = 0; i < n; ++i) {
      residuals[i] = (blocks[0][i] - mean_[i]) / sigma_[i];
      for (std::size_t j = 0; jacobians && jacobians[0] && j < n; ++j) {
        jacobians[0][i * n + j] = i == j ? 1.0 / sigma_[i] : 0.0;
      }
    }
    return true;
  }

 private:
  std::vector<double> mean_;
  const std::vector<double>& sigma_;
};

class Watcher : public ceres::IterationCallback {
 public:
  Watcher(const FitOptions& options, bool free) : options_(options), free_(free) {}
  ceres::CallbackReturnType operator()(const ceres::IterationSummary& summary) override {
    const bool on = options_.progress({free_, summary.iteration, 2.0 * summary.cost});
    return on ? ceres::SOLVER_CONTINUE : ceres::SOLVER_ABORT;
  }

 private:
  const FitOptions& options_;
  bool free_;
};

/// Everything of one fit.
class Search {
 public:
  Search(const Family& family, const Rig& rig, const std::vector<Stretch>& stretches,
         const Cuts& cuts, const FitOptions& options)
      : options_(options), sensors_(*rig.sensors), machines_(family, unknowns_) {
    for (const Parameter& p : family.parameters()) unknowns_.x.push_back(p.start / p.scale);
    segments_ = cut(rig, family.machine_at(unknowns_.x), stretches, cuts, biases_);
    unknowns_.bias.assign(biases_.size(), 0.0);
    for (const Segment& segment : segments_) {
      unknowns_.starts.emplace_back(segment.start.data(),
                                    segment.start.data() + segment.start.size());
    }
    FLAGS_minloglevel = google::GLOG_FATAL;  // Ceres would write of steps that it takes back
    build();
  }
  Search(const Search&) = delete;
  Search& operator=(const Search&) = delete;

  Fit run() {
    Fit result;
    problem_->SetParameterBlockConstant(unknowns_.x.data());
    solve(false, kRoughly);
    result.before = agreement();
    problem_->SetParameterBlockVariable(unknowns_.x.data());
    machines_.free = true;
    if (options_.belief > kFirstBelief) {
      belief_.assign(belief_.size(), kFirstBelief);
      solve(true, kRoughly);
    }
    belief_.assign(belief_.size(), options_.belief);
    const ceres::Solver::Summary summary = solve(true, kTolerance);
    result.after = agreement();
    result.x = unknowns_.x;
    result.bias = unknowns_.bias;
    result.biases = biases_;
    result.information = information();
    result.ending = summary.message;
    result.iterations = static_cast<int>(summary.iterations.size());
    double unknown = static_cast<double>(unknowns_.x.size() + unknowns_.bias.size());
    for (const Segment& segment : segments_) {
      if (!segment.continued) unknown += static_cast<double>(segment.start.size());
    }
    result.freedom = std::max(1.0, static_cast<double>(result.after.points.size()) - unknown);
    return result;
  }

 private:
  void build() {
    ceres::Problem::Options options;
    options.evaluation_callback = &machines_;
    problem_ = std::make_unique<ceres::Problem>(options);
    const int biases = static_cast<int>(biases_.size());
    const int parameters = static_cast<int>(unknowns_.x.size());
    for (std::size_t k = 0; k < segments_.size(); ++k) {
      std::vector<double*> blocks{unknowns_.starts[k].data()};
      if (segments_[k].continued) blocks.push_back(unknowns_.starts[k + 1].data());
      blocks.push_back(unknowns_.x.data());
      if (biases > 0) blocks.push_back(unknowns_.bias.data());
      problem_->AddResidualBlock(
          new SegmentCost(segments_[k], machines_, sensors_, parameters, biases), nullptr, blocks);
    }
    belief_.assign(unknowns_.x.size(), options_.belief);
    problem_->AddResidualBlock(new Belief(unknowns_.x, belief_), nullptr, unknowns_.x.data());
    if (biases == 0) return;
    for (const Bias& bias : biases_) bias_sigma_.push_back(bias.sigma);
    problem_->AddResidualBlock(new Belief(unknowns_.bias, bias_sigma_), nullptr,
                               unknowns_.bias.data());
  }

  ceres::Solver::Summary solve(bool free, double tolerance) {
    Watcher watcher(options_, free);
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
    options.num_threads = options_.threads;
    options.max_num_iterations = options_.iterations;
    options.max_num_consecutive_invalid_steps = 30;
    options.function_tolerance = tolerance;
    options.logging_type = ceres::SILENT;
    options.callbacks.push_back(&watcher);
    ceres::Solver::Summary summary;
    ceres::Solve(options, problem_.get(), &summary);
    if (summary.termination_type == ceres::USER_FAILURE) throw NotDone("stopped");
    if (!summary.IsSolutionUsable()) {
      throw NotDone("the model cannot be followed through these logs: " + summary.message +
                    "; try a shorter --segment, or a rig file that is nearer to the rig");
    }
    // Where the last point was a step that was taken back, the machines are not those of x.
    machines_.PrepareForEvaluation(free, true);
    return summary;
  }

  bool shoot_segment(std::size_t k, bool derivatives, Shot& shot) const {
    const std::span<const double> next = segments_[k].continued
                                             ? std::span<const double>(unknowns_.starts[k + 1])
                                             : std::span<const double>();
    return shoot(segments_[k], *machines_.around(), sensors_, unknowns_.starts[k], next,
                 unknowns_.bias, derivatives, shot);
  }

  Agreement agreement() const {
    Agreement all;
    Shot shot;
    for (std::size_t k = 0; k < segments_.size(); ++k) {
      const Segment& segment = segments_[k];
      if (!shoot_segment(k, false, shot)) throw NotDone("the model cannot be followed");
      for (std::size_t i = 0; i < segment.rows.size(); ++i) {
        const Row& row = segment.rows[i];
        const double off = shot.residual[static_cast<Eigen::Index>(i)];
        const auto tick = static_cast<double>(segment.stretch->moments[row.moment].tick);
        all.points.push_back({segment.stretch, segment.stretch->tick_s * tick, row.reading,
                              row.value, row.value + off * row.sigma, row.sigma});
        all.chi_square += off * off;
      }
    }
    return all;
  }

  Eigen::MatrixXd information() const {
    InformationFilter filter(static_cast<Eigen::Index>(unknowns_.x.size()), biases_);
    Shot shot;
    for (std::size_t k = 0; k < segments_.size(); ++k) {
      if (!shoot_segment(k, true, shot)) throw NotDone("the model cannot be followed");
      filter.add(segments_[k], shot, machines_.around()->machine.coordinates());
    }
    return filter.root();
  }

  const FitOptions& options_;
  const Rig::Sensors& sensors_;
  Unknowns unknowns_;
  Machines machines_;
  std::vector<Bias> biases_;
  std::vector<Segment> segments_;
  std::vector<double> belief_, bias_sigma_;
  std::unique_ptr<ceres::Problem> problem_;  // last: it uses all the others
};

}  // namespace

double Agreement::rms(int reading) const {
  double sum = 0.0;
  double count = 0.0;
  for (const Point& p : points) {
    if (p.reading != reading) continue;
    const double off = (p.predicted - p.measured) / p.sigma;
    sum += off * off;
    count += 1.0;
  }
  return count > 0.0 ? std::sqrt(sum / count) : 0.0;
}

std::vector<int> Agreement::readings() const {
  std::vector<int> all;
  for (int reading = 0; reading < kReadings; ++reading) {
    if (std::ranges::find(points, reading, &Point::reading) != points.end()) all.push_back(reading);
  }
  return all;
}

double Fit::inflation() const {
  const double reduced = reduced_chi_square();
  return reduced > kGoodEnough ? std::sqrt(reduced) : 1.0;
}

Fit fit(const Family& family, const Rig& rig, const std::vector<Stretch>& stretches,
        const Cuts& cuts, const FitOptions& options) {
  return Search(family, rig, stretches, cuts, options).run();
}

}  // namespace gyrotwin::calibration
