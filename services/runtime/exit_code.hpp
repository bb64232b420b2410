// How programs end.
#pragma once

namespace gyrotwin {

/// The program did what it was asked for; it could not (refused, fell, timed out); it was asked
/// wrongly (command line, rig file); this host is not ready for it yet (EX_TEMPFAIL of sysexits.h).
enum ExitCode : int { kDone = 0, kNotDone = 1, kUsage = 2, kNotReady = 75 };

}  // namespace gyrotwin
