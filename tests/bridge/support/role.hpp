// A role that the test program plays in its own process, which a test starts, stops and kills.
//
//    const auto* const kPatient = test::Role::add("patient-station", [] { ... });
//    test::Process station = test::play("patient-station");        // in the test
//
// The process runs the role before the first test and then ends.
#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <string_view>

#include "tests/bridge/support/process.hpp"

namespace fieldcast::test {

inline constexpr const char* kRoleVariable = "FIELDCAST_TEST_ROLE";

class Role : public ::testing::Environment {
 public:
  static Role* add(const char* name, void (*part)()) {
    return static_cast<Role*>(::testing::AddGlobalTestEnvironment(new Role(name, part)));
  }
  void SetUp() override {
    const char* asked = std::getenv(kRoleVariable);
    if (asked == nullptr || std::string_view(asked) != name_) return;
    part_();
    std::_Exit(0);
  }

 private:
  Role(const char* name, void (*part)()) : name_(name), part_(part) {}
  const std::string_view name_;
  void (*const part_)();
};

[[nodiscard]] inline Process play(const char* role) {
  struct Asked {
    explicit Asked(const char* name) { EXPECT_EQ(::setenv(kRoleVariable, name, 1), 0); }
    ~Asked() { ::unsetenv(kRoleVariable); }
  };
  const Asked asked(role);
  return Process("/proc/self/exe", {});
}

}  // namespace fieldcast::test
