// Shows a running bake: one line redrawn in place on a terminal, now and then a plain line elsewhere.
#pragma once
#include <cstdio>
#include <string>

#include "goldthread/bake.h"

namespace goldthread::cli {

/// "solve 43%  1.8 Mrays/s  error 2.1%  12 s left", without the bar.
std::string describe(const BakeEvent& event);

class ProgressLine {
 public:
  enum class Style { kNone, kPlain, kTerminal };

  /// Writes to standard error: kTerminal when that is a terminal, else kPlain; kNone when `quiet`.
  explicit ProgressLine(bool quiet);
  ProgressLine(std::FILE* out, Style style) : out_(out), style_(style) {}
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;
  ~ProgressLine() { clear(); }

  void show(const BakeEvent& event);
  /// Wipes the line that is being redrawn.
  void clear();

 private:
  void draw(const BakeEvent& event);

  std::FILE* out_;
  Style style_;
  bool drawn_ = false;
  std::string last_stage_;
  double last_shown_ = -1e9;  ///< BakeEvent::seconds
};

}  // namespace goldthread::cli
