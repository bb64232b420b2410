// How programs say that something did not work.
#pragma once

#include <stdexcept>
#include <string>

namespace gyrotwin {

/// Setting up failed. what() says what was found, what was expected, and the fix; programs print it
/// and exit with 2. Never thrown after a daemon has started to tick.
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// What this host has not got yet, and may have later without anybody changing the question: a
/// network interface. Programs exit with 75, upon which a service manager tries again.
class NotReady : public Error {
 public:
  using Error::Error;
};

/// The command line lacks something, or says what does not go together. Programs say where --help
/// is, too, and exit with 2.
class UsageError : public Error {
 public:
  using Error::Error;
};

/// What was asked for did not come about: refused, not answered, not in time. what() says why and
/// what to do; programs print it and exit with 1.
class NotDone : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace gyrotwin
