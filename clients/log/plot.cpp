#include "clients/log/plot.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cstdio>
#include <limits>
#include <map>
#include <optional>

#include "clients/log/envelope.hpp"
#include "clients/log/export_field.hpp"
#include "clients/log/export_file.hpp"
#include "clients/log/log_scan.hpp"
#include "clients/plot/chart.hpp"
#include "services/runtime/error.hpp"
#include "services/runtime/exit_code.hpp"
#include "services/runtime/spelling.hpp"

namespace gyrotwin {

namespace {

constexpr std::size_t kStretches = 4096;                     // of a curve; a panel has 552 pixels
constexpr std::size_t kCurves = 7;                           // of a panel: one a colour
constexpr double kPanelWidth = 640.0, kPanelHeight = 240.0;  // [pixel]
constexpr double kLegendLine = 18.0;                         // and as many more a curve
const std::vector<std::string> kUsual{"LIVE/STATE.tilt_rad", "LIVE/STATE.gimbal_angle_rad",
                                      "LIVE/STATE.disc_tilt_rad", "LIVE/STATE.disc_rate_rad_s",
                                      "LIVE/STATE.drive_torque_nm"};

/// LIVE/STATE.tilt_rad[0], taken apart.
struct Wanted {
  std::string text, channel, field;
  bool found = false;

  explicit Wanted(const std::string& words) : text(words) {
    const std::size_t slash = words.rfind('/');
    const std::size_t dot = words.find('.', slash == std::string::npos ? 0 : slash);
    if (dot == std::string::npos || dot == 0 || dot + 1 == words.size()) {
      throw Error("--field " + words + ": expected CHANNEL.FIELD, e.g. LIVE/STATE.tilt_rad[0]");
    }
    channel = words.substr(0, dot);
    field = words.substr(dot + 1);
  }
  bool is_on(std::string_view name) const {
    return name == channel || name.ends_with('/' + channel);
  }
};

/// One element of a field of one stream.
struct Trace {
  std::size_t stream;
  std::string channel, element, unit;
  LcmNumber number;
  Envelope envelope{kStretches};
};

[[noreturn]] void refuse(const Wanted& wanted, const LcmType& type,
                         const std::vector<TableField>& fields) {
  std::vector<std::string_view> names;
  for (const TableField& field : fields) {
    names.push_back(field.name);
    if (field.elements.front() == field.name) continue;
    names.insert(names.end(), field.elements.begin(), field.elements.end());
  }
  std::string all;
  for (const TableField& field : fields) all += (all.empty() ? "" : ", ") + field.name;
  throw Error(fmt::format("--field {}: {} has no field {}; its fields are {}{}", wanted.text,
                          type.name, wanted.field, all,
                          did_you_mean(nearest(wanted.field, names))));
}

/// The curves of a log, found as its channels come up.
class Traces {
 public:
  explicit Traces(const std::vector<std::string>& fields) {
    for (const std::string& field : fields) wanted_.emplace_back(field);
  }

  Selection selection(double from_s, double to_s) const {
    Selection selection{.channels = {}, .from_s = from_s, .to_s = to_s};
    for (const Wanted& wanted : wanted_) selection.channels.push_back(wanted.channel);
    return selection;
  }

  void take(const LogMessage& message) {
    if (message.stream == streams_) {
      begin_stream(message);
      ++streams_;
    }
    for (Trace& trace : traces_) {
      if (trace.stream != message.stream) continue;
      trace.envelope.add(message.seconds, number_at(message.event.data, trace.number));
    }
  }

  /// In the order they were asked for. @throws NotDone for one whose channel did not come up
  std::vector<Trace> finish() {
    for (const Wanted& wanted : wanted_) {
      if (wanted.found) continue;
      throw NotDone("--field " + wanted.text + ": the log has no message on " + wanted.channel +
                    "; `gyrotwin log info` tells which channels it has");
    }
    return std::move(traces_);
  }

 private:
  void begin_stream(const LogMessage& message) {
    const std::vector<TableField> fields = table_fields(message.type);
    for (Wanted& wanted : wanted_) {
      if (!wanted.is_on(message.event.channel)) continue;
      const std::size_t before = traces_.size();
      for (const TableField& field : fields) {
        for (std::size_t i = 0; i < field.elements.size(); ++i) {
          if (wanted.field != field.name && wanted.field != field.elements[i]) continue;
          if (field.is_text) throw Error("--field " + wanted.text + ": is a text, not a number");
          traces_.push_back({message.stream, std::string(message.event.channel), field.elements[i],
                             field.unit, field.number(i)});
        }
      }
      if (traces_.size() == before) refuse(wanted, message.type, fields);
      wanted.found = true;
    }
  }

  std::vector<Wanted> wanted_;
  std::vector<Trace> traces_;
  std::size_t streams_ = 0;
};

/// "LIVE/STATE" of a rig with the prefix.
std::string without_prefix(const std::string& channel, const std::optional<About>& about) {
  const std::string prefix = about ? about->prefix + '/' : "";
  return channel.starts_with(prefix) ? channel.substr(prefix.size()) : channel;
}

/// Panels below each other, each of one unit.
std::vector<Chart> panels(const std::vector<Trace>& traces, const LogScan& scan) {
  const bool one_channel = std::ranges::all_of(
      traces, [&](const Trace& trace) { return trace.channel == traces.front().channel; });
  std::vector<Chart> charts;
  std::map<std::string, std::size_t> of_unit;  // the last panel that is of it
  double first_s = std::numeric_limits<double>::infinity(), last_s = -first_s;
  for (const Trace& trace : traces) {
    const auto [panel, fresh] = of_unit.try_emplace(trace.unit, charts.size());
    if (fresh || charts[panel->second].curves.size() == kCurves) {
      panel->second = charts.size();
      charts.push_back({.title = "",
                        .x = {"time since the first message [s]"},
                        .y = {trace.unit.empty() ? "" : '[' + trace.unit + ']'},
                        .curves = {},
                        .height = kPanelHeight});
    }
    Chart& chart = charts[panel->second];
    Envelope::Points points = trace.envelope.points();
    if (!points.x.empty()) {
      first_s = std::min(first_s, points.x.front());
      last_s = std::max(last_s, points.x.back());
    }
    const std::string channel = without_prefix(trace.channel, scan.about());
    chart.curves.push_back({.name = one_channel ? trace.element : channel + '.' + trace.element,
                            .x = std::move(points.x),
                            .y = std::move(points.y)});
    chart.height += kLegendLine;
  }
  for (Chart& chart : charts) {  // one time axis for all
    if (first_s > last_s) break;
    chart.x.low = first_s;
    chart.x.high = last_s;
  }
  charts.front().title = scan.file().filename().string();
  if (one_channel) charts.front().title += "  " + traces.front().channel;
  return charts;
}

std::string drawing(const std::vector<Chart>& charts) {
  std::string inside;
  double height = 0.0;
  for (const Chart& chart : charts) {
    inside += fmt::format("<svg y='{:.0f}' width='{:.0f}' height='{:.0f}'>{}</svg>\n", height,
                          kPanelWidth, chart.height, svg(chart));
    height += chart.height;
  }
  return fmt::format(
      "<svg xmlns='http://www.w3.org/2000/svg' width='{0:.0f}' height='{1:.0f}' "
      "viewBox='0 0 {0:.0f} {1:.0f}'>\n{2}</svg>\n",
      kPanelWidth, height, inside);
}

}  // namespace

int plot_log(const PlotOptions& options) {
  const bool usual = options.fields.empty();
  const std::filesystem::path output =
      !options.output.empty() ? options.output : options.file.filename().replace_extension(".svg");
  OutputFile file(output, options.force);
  Traces traces(usual ? kUsual : options.fields);
  LogScan scan(options.file, traces.selection(options.from_s, options.to_s));
  scan.read([&](const LogMessage& message) { traces.take(message); });
  std::vector<Trace> drawn = traces.finish();
  if (usual) {
    // What a rig does not have is 0 throughout.
    std::erase_if(drawn, [](const Trace& trace) { return trace.envelope.is_zero(); });
    if (drawn.empty()) throw NotDone("LIVE/STATE is 0 throughout; name what to draw with --field");
  }
  file.write(drawing(panels(drawn, scan)));
  file.finish();
  scan.tell_losses();
  std::printf("%s: %zu curves of %lld messages\n", output.c_str(), drawn.size(),
              static_cast<long long>(scan.messages()));
  return kDone;
}

}  // namespace gyrotwin
