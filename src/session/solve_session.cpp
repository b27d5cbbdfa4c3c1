#include "session/solve_session.h"

#include <chrono>

#include "reconstruct/reconstruct.h"

namespace goldthread {

SolveSession::SolveSession(HierarchicalSolver& solver) : solver_(solver) {}

SolveSession::~SolveSession() {
  cancel();
  if (thread_.joinable()) thread_.join();
}

void SolveSession::start() {
  solver_.between_waves = [this] { breathe(false); };
  thread_ = std::thread([this] { run(); });
}

void SolveSession::pause() {
  const std::lock_guard lock(mutex_);
  paused_ = true;
}

void SolveSession::resume() {
  {
    const std::lock_guard lock(mutex_);
    paused_ = false;
  }
  changed_.notify_all();
}

void SolveSession::cancel() {
  cancel_.cancel();
  changed_.notify_all();
}

bool SolveSession::wait(int milliseconds) {
  std::unique_lock lock(mutex_);
  return changed_.wait_for(lock, std::chrono::milliseconds(milliseconds), [this] { return finished_; });
}

SolveProgress SolveSession::progress() const {
  const std::lock_guard lock(mutex_);
  return progress_;
}

std::shared_ptr<const Lighting> SolveSession::snapshot() const {
  const std::lock_guard lock(mutex_);
  return snapshot_;
}

void SolveSession::run() {
  bool first = true;
  while (solver_.step(cancel_)) {
    breathe(first);
    first = false;
  }
  breathe(first);
  {
    const std::lock_guard lock(mutex_);
    finished_ = true;
  }
  changed_.notify_all();
}

void SolveSession::breathe(bool picture_due) {
  if (watch && watch()) cancel_.cancel();
  if (picture_due || wanted_.exchange(false, std::memory_order_relaxed)) publish();
  std::unique_lock lock(mutex_);
  const SolveStats& stats = solver_.stats();
  progress_ = {solver_.share_done(),         stats.epsilon,        stats.error_estimate, stats.rays.rays,
               solver_.links().all().size(), solver_.pool().size()};
  // Woken now and then, because a cancel may come from where no lock can be taken.
  while (paused_ && !cancel_.cancelled()) changed_.wait_for(lock, std::chrono::milliseconds(50));
}

void SolveSession::publish() {
  auto lighting = std::make_shared<Lighting>(average_lighting(solver_));
  lighting->revision = ++revision_;
  const std::lock_guard lock(mutex_);
  snapshot_ = std::move(lighting);
}

}  // namespace goldthread
