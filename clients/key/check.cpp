#include "clients/key/check.hpp"

#include <spdlog/fmt/fmt.h>
#include <sys/stat.h>
#include <unistd.h>

#include <numeric>

#include "services/runtime/clock.hpp"
#include "services/runtime/error.hpp"
#include "services/runtime/key.hpp"
#include "services/runtime/rig_bus.hpp"

namespace gyrotwin {

namespace {

namespace fs = std::filesystem;

/// load_key() says what is wrong with content and mode; whose it is stands here.
Finding examine_file(const fs::path& path) {
  try {
    load_key(path);
  } catch (const Error& error) {
    return {false, error.what()};
  }
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0 || status.st_uid != ::geteuid()) {
    return {false, fmt::format("{}: belongs to another user, who can change it; `chown {} {}`, or "
                               "copy it and remove this one",
                               path.string(), ::geteuid(), path.string())};
  }
  return {true, fmt::format("{}: a key, yours alone (mode {:04o})", path.string(),
                            status.st_mode & 07777)};
}

/// Who can write to the folder can put another key in place of this one.
Finding examine_folder(const fs::path& folder) {
  struct stat status {};
  if (::stat(folder.c_str(), &status) != 0) return {false, folder.string() + ": cannot be read"};
  const unsigned mode = status.st_mode & 07777;
  if (status.st_uid != ::geteuid() && status.st_uid != 0) {
    return {false, fmt::format("{}: the folder belongs to another user, who can replace the key; "
                               "set GYROTWIN_KEYS to a folder of your own",
                               folder.string())};
  }
  if ((mode & (S_IWGRP | S_IWOTH)) != 0) {
    return {false, fmt::format("{}: others can write to the folder (mode {:04o}) and replace the "
                               "key; `chmod 700 {}`",
                               folder.string(), mode, folder.string())};
  }
  return {true,
          fmt::format("{}: nobody else writes to the folder (mode {:04o})", folder.string(), mode)};
}

}  // namespace

std::vector<Finding> examine_key(const Rig& rig) {
  const fs::path path = key_path(rig.name);
  std::vector<Finding> found;
  if (rig.network.sign) {
    found.push_back({true, "rig " + rig.name + " signs every message and checks it"});
  } else {
    found.push_back({false, "rig " + rig.name +
                                " signs nothing, and whoever reaches its bus can "
                                "steer it: network.sign = false in " +
                                rig.file.string()});
  }
  found.push_back(examine_file(path));
  if (fs::exists(path)) found.push_back(examine_folder(fs::absolute(path).parent_path()));
  return found;
}

Heard listen(const Rig& rig, double seconds) {
  Bus bus(bus_config(rig, header_t::OPERATOR));
  MonotonicClock clock;
  const auto end = clock.now_ns() + static_cast<std::int64_t>(1e9 * seconds);
  for (std::int64_t now = clock.now_ns(); now < end; now = clock.now_ns()) {
    bus.wait(end - now);
    while (bus.receive()) {
    }
  }
  const BusCounters& counters = bus.counters();
  const auto sum = [](const auto& each) {
    return std::accumulate(each.begin(), each.end(), std::int64_t{0});
  };
  return {.with_this_key = sum(counters.received) + sum(counters.reordered),
          .otherwise = counters.unauthentic,
          .seconds = seconds};
}

Finding judge(const Heard& heard) {
  const std::int64_t all = heard.with_this_key + heard.otherwise;
  if (all == 0) {
    return {true, fmt::format("nobody was heard on the rig's bus for {:g} s: whether others have "
                              "this key shows when they run",
                              heard.seconds)};
  }
  if (heard.otherwise == 0) {
    return {true, fmt::format("{} messages heard in {:g} s, all signed with this key", all,
                              heard.seconds)};
  }
  return {false,
          fmt::format("{} of {} messages heard in {:g} s are not signed with this key: somebody "
                      "uses another one; compare `gyrotwin key show-id` on every host, for every "
                      "user",
                      heard.otherwise, all, heard.seconds)};
}

}  // namespace gyrotwin
