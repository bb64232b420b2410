// gyrotwin-top: how a rig is, live, by listening alone.
#include <langinfo.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <clocale>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>

#include "clients/top/monitor.hpp"
#include "clients/top/screen.hpp"
#include "clients/top/terminal.hpp"
#include "services/runtime/cli.hpp"
#include "services/runtime/clock.hpp"
#include "services/runtime/rig_bus.hpp"

namespace gyrotwin {

namespace {

constexpr std::int64_t kListenNs = 10'000'000;  // between two looks into the bus's buffer
constexpr std::int64_t kRedrawNs = 100'000'000;
constexpr double kDay = 86400.0;  // [s]

/// What the command line says.
struct Options {
  double interval_s = 1.0;
  std::int64_t count = 0;
  bool json = false;
  bool plain = false;  ///< text though stdout is a terminal
};

Glyphs glyphs_of_locale() {
  std::setlocale(LC_CTYPE, "");
  return {.unicode = std::string_view(::nl_langinfo(CODESET)) == "UTF-8"};
}

/// https://no-color.org
bool colour_wanted() {
  const char* refused = std::getenv("NO_COLOR");
  return refused == nullptr || *refused == '\0';
}

/// The bus, and what was heard on it.
class Ear {
 public:
  explicit Ear(const Rig& rig) : bus_(bus_config(rig, header_t::OPERATOR)) {}

  /// Takes in what has come. @return how long to sleep before the next time
  std::int64_t listen() {
    const Moment now = moment();
    while (const auto reception = bus_.receive()) monitor_.hear(*reception, now);
    monitor_.look(now, bus_.counters());
    return bus_.wait(0) ? 0 : kListenNs;
  }
  Picture picture() const { return monitor_.picture(moment()); }
  std::int64_t now_ns() const { return clock_.now_ns(); }

 private:
  Moment moment() const {
    const auto utc = std::chrono::system_clock::now().time_since_epoch();
    return {clock_.now_ns(), std::chrono::nanoseconds(utc).count()};
  }

  MonotonicClock clock_;
  Bus bus_;
  Monitor monitor_;
};

int show_screen(Ear& ear, const RigFacts& facts, Signals& signals) {
  const Glyphs glyphs = glyphs_of_locale();
  const bool colour = colour_wanted();
  Terminal terminal;
  Lines shown;
  Size size = Terminal::size();
  std::int64_t due = ear.now_ns();
  for (;;) {
    const std::int64_t sleep = ear.listen();
    if (ear.now_ns() >= due) {
      Lines next = screen(ear.picture(), facts, size, glyphs);
      if (!Terminal::write(ansi_update(shown, next, colour))) return kNotDone;
      shown = std::move(next);
      due = ear.now_ns() + kRedrawNs;
    }
    const Wish wish = signals.wait(sleep, true);
    if (wish == Wish::kEnd) return kDone;
    if (wish == Wish::kNothing) continue;
    if (wish == Wish::kSuspend) terminal.suspend();
    size = Terminal::size();
    shown.clear();
    due = ear.now_ns();
    Terminal::write("\x1b[2J");
  }
}

int print_blocks(Ear& ear, const RigFacts& facts, Signals& signals, const Options& options) {
  const Glyphs glyphs = glyphs_of_locale();
  const auto interval = static_cast<std::int64_t>(std::llround(1e9 * options.interval_s));
  std::int64_t told = 0;
  std::int64_t due = ear.now_ns() + interval;
  for (std::int64_t printed = 0; options.count == 0 || printed < options.count;) {
    const std::int64_t sleep = ear.listen();
    if (ear.now_ns() >= due) {
      const Picture picture = ear.picture();
      const std::string text =
          options.json ? json_text(picture, facts, told) : plain_text(picture, facts, glyphs, told);
      if (!Terminal::write(text)) return kNotDone;
      if (!picture.happenings.empty()) told = picture.happenings.back().number;
      ++printed;
      due += interval;
    }
    if (signals.wait(std::min(sleep, std::max<std::int64_t>(due - ear.now_ns(), 0)), false) ==
        Wish::kEnd) {
      break;
    }
  }
  return kDone;
}

int run(const RigOptions& rig_options, const Options& options) {
  const Rig rig = rig_options.load();
  const RigFacts facts = facts_of(rig);
  Ear ear(rig);
  Signals signals;
  const bool full_screen = ::isatty(STDOUT_FILENO) != 0 && !options.json && !options.plain;
  return full_screen ? show_screen(ear, facts, signals)
                     : print_blocks(ear, facts, signals, options);
}

}  // namespace

}  // namespace gyrotwin

int main(int argc, char** argv) {
  gyrotwin::CommandLine app("Shows how a rig is, live. Only listens.", "gyrotwin-top");
  app.footer(
      "On a terminal a full screen, q or Ctrl-C leave it; elsewhere a block of text a second.\n"
      "Colours follow NO_COLOR, bars the locale.\n"
      "Examples:\n"
      "  gyrotwin top\n"
      "  gyrotwin top --count 1\n"
      "  gyrotwin top --json --interval 0.1 | jq .state.tilt_rad");
  const gyrotwin::RigOptions rig_options(app);
  gyrotwin::Options options;
  app.add_flag("--json", options.json, "One JSON object a line, for programs");
  const gyrotwin::Option interval =
      app.add_option("--interval", options.interval_s,
                     "Text or JSON: wall time between two [s]; gives text on a terminal too")
          .type("S")
          .shows_default()
          .check(gyrotwin::number_within(0.01, gyrotwin::kDay).untold());
  const gyrotwin::Option count =
      app.add_option("--count", options.count,
                     "Text or JSON: end after so many; 0: never; gives text on a terminal too")
          .type("N")
          .check(gyrotwin::whole_within(0, 1'000'000'000'000).untold());
  return app.run(argc, argv, [&] {
    options.plain = interval.given() || count.given();
    return run(rig_options, options);
  });
}
