// Ctrl-C ends work in an orderly way: nothing half written, no child process left.
#pragma once

#include "isochor/base/progress.h"

namespace isochor::app {

// From now on SIGINT and SIGTERM raise `token`. The second signal ends the program at once, for
// work that does not look at the token.
void cancel_on_signals(const CancelToken& token);

}  // namespace isochor::app
