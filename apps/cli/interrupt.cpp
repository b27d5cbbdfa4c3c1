#include "interrupt.h"

#include <unistd.h>
#include <csignal>

#include "goldthread/error.h"

namespace goldthread::cli {
namespace {

volatile std::sig_atomic_t interrupt_count = 0;  // all that a signal handler may safely touch

extern "C" void count_interrupt(int) {
  if (interrupt_count > 0) _exit(static_cast<int>(ErrorCode::kCancelled));
  interrupt_count = 1;
}

}  // namespace

void catch_interrupts() {
  struct sigaction action = {};
  action.sa_handler = count_interrupt;
  sigemptyset(&action.sa_mask);
  action.sa_flags = SA_RESTART;  // reading and writing files goes on
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

bool interrupted() {
  return interrupt_count > 0;
}

}  // namespace goldthread::cli
