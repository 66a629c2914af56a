// Independent tasks on a few threads.
#pragma once

#include <functional>

namespace isochor {

// Calls task(0) .. task(count - 1), each once, on up to `threads` threads, this one among them;
// returns when all are done. Which thread runs a task is left to chance, so tasks write to places
// of their own. An exception ends the distribution of tasks; the one of the lowest-numbered task
// that threw is thrown again here. Threads are made for the call (some 20 us each): worth it from
// about a millisecond of work.
void run_tasks(int count, int threads, const std::function<void(int)>& task);

}  // namespace isochor
