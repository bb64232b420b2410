// Being asked to stop.
#pragma once

#include <csignal>

namespace gyrotwin {

/// SIGINT, SIGTERM and SIGHUP, kept waiting so that no row is cut and nothing is left running; a
/// reader of the output that goes away ends nothing.
class Interrupt {
 public:
  Interrupt() {
    sigemptyset(&signals_);
    sigaddset(&signals_, SIGINT);
    sigaddset(&signals_, SIGTERM);
    sigaddset(&signals_, SIGHUP);
    signal(SIGPIPE, SIG_IGN);
    sigprocmask(SIG_BLOCK, &signals_, nullptr);
  }
  bool wanted() const {
    sigset_t pending;
    sigpending(&pending);
    return sigismember(&pending, SIGINT) == 1 || sigismember(&pending, SIGTERM) == 1 ||
           sigismember(&pending, SIGHUP) == 1;
  }

 private:
  sigset_t signals_;
};

}  // namespace gyrotwin
