// Being asked to stop.
#pragma once

#include <csignal>

namespace gyrotwin {

/// SIGINT and SIGTERM, kept waiting so that no row is cut.
class Interrupt {
 public:
  Interrupt() {
    sigemptyset(&signals_);
    sigaddset(&signals_, SIGINT);
    sigaddset(&signals_, SIGTERM);
    sigprocmask(SIG_BLOCK, &signals_, nullptr);
  }
  bool wanted() const {
    sigset_t pending;
    sigpending(&pending);
    return sigismember(&pending, SIGINT) == 1 || sigismember(&pending, SIGTERM) == 1;
  }

 private:
  sigset_t signals_;
};

}  // namespace gyrotwin
