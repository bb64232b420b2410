#include "clients/log/recover.hpp"

#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>

#include "clients/log/log.hpp"
#include "services/runtime/error.hpp"
#include "services/runtime/exit_code.hpp"

namespace gyrotwin {

int recover(const std::filesystem::path& from, const std::filesystem::path& to) {
  constexpr std::size_t kPiece = 1 << 20;  // written at once [byte]
  Log log(from);
  LogWriter writer(to);
  LogBytes piece;
  while (const auto event = log.next()) {
    append_event(piece, *event);
    if (piece.size() < kPiece) continue;
    writer.append(piece);
    piece.clear();
  }
  writer.append(piece);
  if (::fsync(writer.descriptor()) != 0) {
    throw NotDone(to.string() + ": the disk did not keep it: " + std::strerror(errno));
  }
  std::printf("kept: %lld events, %lld of %lld bytes, in %s\nlost: %s\n",
              static_cast<long long>(writer.events()), static_cast<long long>(writer.size()),
              static_cast<long long>(log.size()), to.c_str(), log.damage_text().c_str());
  return kDone;
}

}  // namespace gyrotwin
