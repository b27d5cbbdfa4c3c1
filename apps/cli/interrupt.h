// Ctrl-C: the first asks politely, the second does not wait.
#pragma once

namespace goldthread::cli {

/// From now on SIGINT and SIGTERM raise a flag; a second one ends the program at once with exit code 130.
void catch_interrupts();
/// Whether the flag is up.
bool interrupted();

}  // namespace goldthread::cli
