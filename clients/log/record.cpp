#include "clients/log/record.hpp"

#include <malloc.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <ctime>
#include <numeric>

#include "clients/log/catalog.hpp"
#include "clients/log/listener.hpp"
#include "clients/log/syncer.hpp"
#include "services/runtime/clock.hpp"
#include "services/runtime/daemon.hpp"
#include "services/runtime/error.hpp"
#include "services/runtime/exit_code.hpp"
#include "services/runtime/rig_bus.hpp"

namespace gyrotwin {

namespace {

constexpr std::chrono::milliseconds kTurn{50};
constexpr std::int64_t kSecond = 1'000'000'000;  // [ns]
/// A buffer below this may overflow on a busy machine [byte, as the kernel counts]: 0.4 s of 20,000
/// STATEs a second.
constexpr int kComfortableBuffer = 8 << 20;

std::int64_t wall_clock_us() {
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  return std::chrono::duration_cast<std::chrono::microseconds>(now).count();
}

/// "prototype_b-20261122-233900.lcm", in local time.
std::string file_name(const Rig& rig) {
  const std::time_t now = std::time(nullptr);
  std::tm local{};
  ::localtime_r(&now, &local);
  char text[32];
  std::strftime(text, sizeof text, "-%Y%m%d-%H%M%S.lcm", &local);
  return rig.name + text;
}

About about(const Rig& rig, const BusConfig& config, int part) {
  return {.program = "gyrotwin-log " GYROTWIN_VERSION,
          .host = Identity().host,
          .part = part,
          .rig = rig.name,
          .prefix = rig.network.prefix,
          .rig_id = rig.id,
          .key = config.key ? fingerprint(*config.key) : "",
          .channels = channels_of(rig.network.prefix)};
}

/// What was heard and is not in the record, or was never heard.
struct Losses {
  std::int64_t kernel, overflowed, gaps;
  std::int64_t all() const { return kernel + overflowed; }
};

Losses losses(Listener& listener) {
  const BusCounters counters = listener.counters();
  return {.kernel = counters.kernel_dropped,
          .overflowed = listener.overflowed(),
          .gaps = std::accumulate(counters.gaps.begin(), counters.gaps.end(), std::int64_t{0},
                                  add_saturating)};
}

/// "nothing", or what.
std::string text_of(const Losses& lost) {
  std::string text;
  const auto add = [&text](std::int64_t count, std::string_view what) {
    if (count > 0) text += fmt::format("{}{} {}", text.empty() ? "" : "; ", count, what);
  };
  add(lost.kernel, "that the receive buffer had no room for");
  add(lost.overflowed, "that the disk was too slow for");
  add(lost.gaps, "sequence numbers that never came");
  return text.empty() ? "nothing" : text;
}

/// Tells once a second how it goes: on a terminal a line that changes, else only of new losses.
class Progress {
 public:
  explicit Progress(Daemon& daemon) : daemon_(daemon) {}

  void tell(const LogSeries& series, const Losses& lost, double seconds) {
    daemon_.show("{:.1f} MB in {} up to {}; lost: {}", 1e-6 * static_cast<double>(series.size()),
                 series.files() == 1 ? "one file" : fmt::format("{} files", series.files()),
                 series.file().path().string(), text_of(lost));
    if (terminal_) {
      std::fprintf(stderr, "\r\x1b[K%.0f s  %lld messages/s  %lld messages  %.1f MB  lost: %s",
                   seconds, static_cast<long long>(series.events() - events_),
                   static_cast<long long>(series.events()),
                   1e-6 * static_cast<double>(series.size()), text_of(lost).c_str());
    } else if (lost.all() > lost_) {
      daemon_.log(LogLevel::kWarning, "lost: {}", text_of(lost));
    }
    if (series.removal_error() && series.files() > warned_at_) {
      daemon_.log(LogLevel::kWarning, "{} cannot be removed: {}; the folder grows beyond --keep",
                  numbered(series.path(), series.removed() + 1).string(),
                  series.removal_error().message());
      warned_at_ = series.files();
    }
    events_ = series.events();
    lost_ = lost.all();
  }
  void end() const {
    if (terminal_) std::fputs("\r\x1b[K", stderr);
  }

 private:
  Daemon& daemon_;
  bool terminal_ = ::isatty(STDERR_FILENO) == 1;
  std::int64_t events_ = 0, lost_ = 0;
  int warned_at_ = 0;  // files made
};

void warn_of_small_buffer(Daemon& daemon, int granted) {
  if (granted >= kComfortableBuffer) return;
  daemon.log(LogLevel::kWarning,
             "the kernel grants a receive buffer of {} kB; many messages on a busy machine may be "
             "lost: `sudo sysctl -w net.core.rmem_max={}`, or CAP_NET_ADMIN",
             granted / 1024, Tap::kReceiveBuffer);
}

void summarise(const Rig& rig, const LogSeries& series, Listener& listener, double seconds) {
  std::string first;
  if (series.files() > 1) first = fmt::format("{} files up to ", series.files());
  if (series.removed() > 0) {
    first = fmt::format("the last {} of ", series.files() - series.removed()) + first;
  }
  std::printf(
      "%s\n",
      fmt::format("recorded {} messages in {:.1f} s, {:.1f} MB: {}{}", series.events(), seconds,
                  1e-6 * static_cast<double>(series.size()), first, series.file().path().string())
          .c_str());
  std::printf("lost: %s\n", text_of(losses(listener)).c_str());
  const BusCounters heard = listener.counters();
  if (heard.unauthentic > 0) {
    std::printf("not recorded: %lld messages that %s did not sign\n",
                static_cast<long long>(heard.unauthentic), key_path(rig.name).c_str());
  }
  if (series.events() == 0) {
    std::printf("nothing of rig %s was heard on %s\n", rig.name.c_str(), reach(rig).c_str());
  }
  std::fflush(stdout);
}

}  // namespace

int record(const Rig& rig, const std::string& rig_file, const RecordOptions& options) {
  Daemon daemon("gyrotwin-log");
  ::signal(SIGXFSZ, SIG_IGN);  // a limit on file sizes is a full disk like another
  // So that what the spool gives back goes to the system, and not to a heap that stays.
  ::mallopt(M_MMAP_THRESHOLD, static_cast<int>(Spool::kCalm));
  const BusConfig config = bus_config(rig, header_t::OPERATOR);
  Tap tap(config, options.keep);
  warn_of_small_buffer(daemon, tap.granted_buffer());

  Syncer syncer;
  const auto opening = [&](int part, std::int64_t time_us) {
    return opening_events(about(rig, config, part), lcm_sources(), rig_file, time_us);
  };
  LogSeries series(
      options.file.empty() ? file_name(rig) : options.file, options.limits, opening,
      [&syncer](const LogWriter& file) { syncer.sync(file.descriptor()); }, wall_clock_us());
  daemon.log(LogLevel::kInfo, "recording rig {}, {}, to {}; Ctrl-C ends", rig.name, reach(rig),
             series.file().path().string());

  Spool spool;
  Listener listener(tap, spool);
  Progress progress(daemon);
  const MonotonicClock clock;
  const std::int64_t begin = clock.now_ns();
  const auto seconds = [&] { return 1e-9 * static_cast<double>(clock.now_ns() - begin); };
  std::int64_t next_tell = begin + kSecond;
  try {
    for (LogBytes events; spool.take(events, kTurn);) {
      series.append(events);
      if (!daemon.next_round()) listener.stop();
      if (clock.now_ns() < next_tell) continue;
      next_tell += kSecond;
      syncer.sync(series.file().descriptor());
      progress.tell(series, losses(listener), seconds());
    }
  } catch (const NotDone&) {
    progress.end();
    summarise(rig, series, listener, seconds());
    throw;
  }
  syncer.sync(series.file().descriptor());
  syncer.finish();
  progress.end();
  summarise(rig, series, listener, seconds());
  return kDone;
}

}  // namespace gyrotwin
