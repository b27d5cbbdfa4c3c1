#pragma once
namespace goldthread {
constexpr const char* kVersion = "0.1.0";
}
