#pragma once

#include <functional>

namespace eg::procman {

/// Runs `work` in a child process and returns its result, in the child as well as in this process: main() returns it.
/// The two watch over each other, so that nothing `work` starts is left even after a SIGKILL to either of them:
/// - this process adopts the orphans of its child, and when the child has ended kills all that is left;
/// - when this process dies, stop_count() in the child jumps to kStopAtOnce, upon which `work` must kill all it has
///   started and return.
/// SIGINT, SIGTERM, SIGHUP and SIGQUIT to this process are passed on to the child, which counts them. To be called
/// before there are threads.
int run_guarded(const std::function<int()>& work);

/// How often this process, a child of run_guarded(), has been asked to stop: the first time means to stop everything in
/// its own time, from kStopAtOnce on to kill everything.
int stop_count();
inline constexpr int kStopAtOnce = 2;

}  // namespace eg::procman
