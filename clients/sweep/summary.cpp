#include "clients/sweep/summary.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "clients/common/tilt.hpp"
#include "clients/plot/page.hpp"
#include "clients/sweep/statistics.hpp"
#include "clients/sweep/summary_charts.hpp"

namespace gyrotwin {

namespace {

using Rows = std::vector<std::vector<std::string>>;

struct Count {
  std::int64_t stand = 0, all = 0;
};

Count count_of(const Results& results) {
  Count count;
  for (std::size_t i = 0; i < results.runs(); ++i) {
    count.all += results.counts(i) ? 1 : 0;
    count.stand += results.stands(i) ? 1 : 0;
  }
  return count;
}

bool listed(const Factor& factor) {
  return !factor.drawn && std::ranges::any_of(factor.texts, [&](const std::string& text) {
    return text != factor.texts.front();
  });
}

/// They are a sample of what there could be.
bool sampled(const Results& results) {
  return std::ranges::any_of(results.factors, &Factor::drawn) &&
         std::ranges::none_of(results.factors, listed);
}

std::string percent(double share) { return fmt::format("{:.3g} %", 100.0 * share); }

void add_verdicts(const Results& results, Page& page) {
  static const std::map<std::string_view, std::pair<const char*, Tone>> kMeaning{
      {kStands, {"to the end", Tone::kGood}},
      {kGrowing, {"not fallen, but tilting further at the end than ever before", Tone::kDoubtful}},
      {kLeans, {"toppled onto its gimbals' stops, which hold it", Tone::kBad}},
      {kFalls,
       {"its tilt passed the fall limit; where nothing tilts, a gimbal met its stop", Tone::kBad}},
      {kFailed, {"no finite motion came out", Tone::kBad}},
      {kImpossible, {"there is no such rig: the rig file's rules refuse it", Tone::kPlain}}};
  Rows rows;
  std::vector<Tone> tones;
  for (const std::string_view verdict : {kStands, kGrowing, kLeans, kFalls, kFailed, kImpossible}) {
    const auto count = std::ranges::count(results.verdicts, verdict);
    if (count == 0) continue;
    const auto& [meaning, tone] = kMeaning.at(verdict);
    rows.push_back({std::string(verdict), fmt::format("{}", count),
                    percent(static_cast<double>(count) / static_cast<double>(results.runs())),
                    meaning});
    tones.push_back(tone);
  }
  page.table({"", "runs", "share", "what it means"}, rows, tones);
}

/// Mean of the chosen runs' numbers as text; empty when there is none.
template <class Choice>
std::string mean_where(const Factor& factor, const Results& results, const Choice& choice) {
  double sum = 0.0;
  std::int64_t count = 0;
  for (std::size_t i = 0; i < results.runs(); ++i) {
    if (!results.counts(i) || !choice(i)) continue;
    sum += factor.numbers[i];
    ++count;
  }
  if (count == 0) return "";
  const auto [low, high] = std::ranges::minmax(factor.numbers);
  const double mean = sum / static_cast<double>(count);
  const bool rounding = std::abs(mean) < 1e-12 * (high - low);
  return fmt::format("{:.4g}", rounding ? 0.0 : mean);
}

std::string correlation(double value) {
  return std::isfinite(value) ? fmt::format("{:+.2f}", value) : "";
}

void add_sensitivities(const Results& results, Page& page) {
  Rows rows;
  bool any_matters = false;
  for (const Factor* factor : by_influence(results)) {
    const Influence seen = influence(*factor, results);
    const Factor shown = seen.by_size ? factor->sizes() : *factor;
    const auto [low, high] = std::ranges::minmax(shown.numbers);
    any_matters |= seen.matters();
    rows.push_back({shown.key, fmt::format("{:.4g}", low), fmt::format("{:.4g}", high),
                    mean_where(shown, results, [&](std::size_t i) { return results.stands(i); }),
                    mean_where(shown, results, [&](std::size_t i) { return !results.stands(i); }),
                    correlation(seen.standing), correlation(seen.tilt)});
  }
  if (rows.empty()) return;
  page.heading("What it hangs on");
  page.paragraph(
      any_matters
          ? "Rank correlations: +1 where a larger value always goes with standing or with more "
            "tilt, -1 where it always goes against it, near 0 where it does not matter or matters "
            "both ways, empty where all runs are alike; |key|: of its size, where that tells more."
          : "Nothing that was varied is seen to matter: its rank correlations with standing and "
            "with more tilt are what chance alone makes of so many runs, or empty where all are "
            "alike.");
  page.table(
      {"key", "from", "to", "mean, stands", "mean, does not", "with standing", "with largest tilt"},
      rows);
}

/// Shares by the words of lists that are not numbers.
void add_words(const Results& results, Page& page) {
  for (const Factor& factor : results.factors) {
    if (!factor.numbers.empty()) continue;
    std::map<std::string, Count> counts;
    for (std::size_t i = 0; i < results.runs(); ++i) {
      if (!results.counts(i)) continue;
      ++counts[factor.texts[i]].all;
      counts[factor.texts[i]].stand += results.stands(i) ? 1 : 0;
    }
    Rows rows;
    for (const auto& [word, count] : counts) {
      rows.push_back(
          {word, fmt::format("{}", count.all), percent(proportion(count.stand, count.all).share)});
    }
    page.heading("By " + factor.key);
    page.table({factor.key, "runs", "stand"}, rows);
  }
}

/// The first run of a verdict with the largest tilt among its like.
std::optional<std::size_t> extreme(const Results& results, std::string_view verdict, bool early) {
  std::optional<std::size_t> found;
  for (std::size_t i = 0; i < results.runs(); ++i) {
    if (results.verdicts[i] != verdict) continue;
    const bool better = !found || (early ? results.fell_at[i] < results.fell_at[*found]
                                         : results.largest_tilt[i] > results.largest_tilt[*found]);
    if (better) found = i;
  }
  return found;
}

void add_repeats(const Results& results, const SummaryText& text, Page& page) {
  Rows rows;
  const auto add = [&](const char* what, std::optional<std::size_t> run) {
    if (run) rows.push_back({what, fmt::format("{}", *run), text.repeat(*run)});
  };
  add("stands with the largest tilt", extreme(results, kStands, false));
  add("leans on its gimbal stops", extreme(results, kLeans, false));
  add("falls first", extreme(results, kFalls, true));
  add("still growing", extreme(results, kGrowing, false));
  add("no finite motion", extreme(results, kFailed, false));
  add("no such rig, and this says why", extreme(results, kImpossible, false));
  if (rows.empty()) return;
  page.heading("See a run again");
  page.table({"which", "run", "command"}, rows);
}

}  // namespace

std::string standing_sentence(const Results& results, const SummaryText& text) {
  const Count count = count_of(results);
  const Proportion p = proportion(count.stand, count.all);
  std::string said =
      fmt::format("{} of {} runs stand: {}", count.stand, count.all, percent(p.share));
  if (sampled(results)) {
    said += fmt::format(", with 95 % confidence {:.3g} to {}", 100.0 * p.low, percent(p.high));
  }
  const auto growing = std::ranges::count(results.verdicts, kGrowing);
  const auto leaning = std::ranges::count(results.verdicts, kLeans);
  if (growing > 0) said += fmt::format("; {} not fallen, but still tilting further", growing);
  if (leaning > 0) said += fmt::format("; {} leaning on gimbal stops", leaning);
  if (const auto none = std::ranges::find(results.verdicts, kImpossible);
      none != results.verdicts.end()) {
    said += fmt::format("; {} more of {} {} no rig: {}",
                        results.runs() - static_cast<std::size_t>(count.all), results.runs(),
                        static_cast<std::size_t>(count.all) + 1 == results.runs() ? "is" : "are",
                        text.refusal(static_cast<std::size_t>(none - results.verdicts.begin())));
  }
  return said;
}

std::string summary_html(const Results& results, const SummaryText& text) {
  const Count count = count_of(results);
  Page page(text.title, text.about);
  page.verdict(count.all == 0             ? Tone::kPlain
               : count.stand == count.all ? Tone::kGood
               : count.stand == 0         ? Tone::kBad
                                          : Tone::kDoubtful,
               standing_sentence(results, text),
               sampled(results) ? "The interval is that of the share among all such rigs."
                                : "Every run is one choice of the values below.");
  if (!text.caution.empty()) page.verdict(Tone::kDoubtful, "But", text.caution);
  page.heading("How the runs end");
  add_verdicts(results, page);
  page.heading("Where it stands");
  for (const CaptionedSvg& figure : summary_charts(results, text.fall_tilt)) {
    page.figure(figure.svg, figure.caption);
  }
  add_words(results, page);
  add_sensitivities(results, page);
  add_repeats(results, text, page);
  page.heading("The data");
  page.paragraph(
      "runs.csv beside this page has one line a run, in their order; sweep.json says what was "
      "asked. The same question gives the same bytes.");
  return page.html();
}

}  // namespace gyrotwin
