#include "clients/log/log_series.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cstdlib>
#include <string>
#include <string_view>
#include <utility>

#include "services/runtime/error.hpp"

namespace gyrotwin {

namespace {

/// Whether `name` is `path`'s, numbered.
bool is_numbered(const std::filesystem::path& path, const std::string& name) {
  const std::string head = path.stem().string() + ".", tail = path.extension().string();
  if (name.size() <= head.size() + tail.size()) return false;
  if (!name.starts_with(head) || !name.ends_with(tail)) return false;
  const std::string_view number(name.data() + head.size(), name.size() - head.size() - tail.size());
  return std::ranges::all_of(number, [](char c) { return c >= '0' && c <= '9'; });
}

/// A series would end, days later, where it met a file of an earlier one.
void refuse_earlier_series(const std::filesystem::path& path) {
  const std::filesystem::path folder = path.has_parent_path() ? path.parent_path() : ".";
  std::error_code unreadable;  // whoever makes the file says why
  for (const auto& file : std::filesystem::directory_iterator(folder, unreadable)) {
    if (!is_numbered(path, file.path().filename().string())) continue;
    throw Error(file.path().string() +
                ": exists already and is kept, as is every file of an earlier record of this name; "
                "name another file, or remove it");
  }
}

}  // namespace

LogSeries::LogSeries(std::filesystem::path path, Limits limits, Opening opening, Finished finished,
                     std::int64_t time_us)
    : path_(std::move(path)),
      limits_(limits),
      opening_(std::move(opening)),
      finished_(std::move(finished)) {
  if (limits_.any()) refuse_earlier_series(path_);
  open_next(time_us);
}

void LogSeries::append(std::span<std::uint8_t> events) {
  std::size_t begin = 0;
  for (std::size_t at = 0; at < events.size();) {
    const LogEvent event = first_event(events.subspan(at));
    if (is_full_for(event, at - begin)) {
      write(events.subspan(begin, at - begin));
      begin = at;
      open_next(event.time_us);
    }
    at += size_in_log(event);
  }
  write(events.subspan(begin));
}

void LogSeries::write(std::span<std::uint8_t> events) {
  const std::int64_t before = file_->events();
  try {
    file_->append(events);
  } catch (const NotDone&) {
    events_ += file_->events() - before;
    throw;
  }
  events_ += file_->events() - before;
}

void LogSeries::open_next(std::int64_t time_us) {
  LogBytes opening = opening_(part_ + 1, time_us);
  LogWriter next(limits_.any() ? numbered(path_, part_ + 1) : path_);
  if (file_) {
    finished_size_ += file_->size();
    finished_(*file_);
  }
  file_.emplace(std::move(next));
  ++part_;
  opened_us_ = time_us;
  file_->append(opening);
  opening_events_ = file_->events();
  remove_oldest();
}

void LogSeries::remove_oldest() {
  removal_error_.clear();
  while (limits_.keep > 0 && part_ - removed_ > limits_.keep) {
    std::filesystem::remove(numbered(path_, removed_ + 1), removal_error_);
    if (removal_error_) return;
    ++removed_;
  }
}

/// @param waiting bytes that go into the file before it
bool LogSeries::is_full_for(const LogEvent& event, std::size_t waiting) const {
  if (file_->events() == opening_events_ && waiting == 0) return false;  // one at least
  const std::int64_t size = file_->size() + static_cast<std::int64_t>(waiting + size_in_log(event));
  if (limits_.bytes > 0 && size > limits_.bytes) return true;
  // Either way: a clock that was set back would keep the file open until it has caught up.
  return limits_.time_us > 0 && std::abs(event.time_us - opened_us_) >= limits_.time_us;
}

std::filesystem::path numbered(const std::filesystem::path& path, int part) {
  std::filesystem::path name = path;
  return name.replace_extension(fmt::format(".{:06}{}", part, path.extension().string()));
}

}  // namespace gyrotwin
