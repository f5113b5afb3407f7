// Checks the text of a dashboard against dashboard_format.json. Pure; the text is untrusted.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <tl/expected.hpp>
#include <vector>

namespace fieldcast::web {

inline constexpr std::size_t kMaxDashboardBytes = 64 * 1024;
inline constexpr int kMaxDashboardDepth = 8;
inline constexpr std::size_t kMaxDashboardFaults = 20;  // reported for one text

struct DashboardFault {
  std::string place;    // "widgets[3].channel", "line 7, column 2"
  std::string what;     // what is wrong, with the value
  std::string allowed;  // what is allowed
  friend bool operator==(const DashboardFault&, const DashboardFault&) = default;
};
using DashboardFaults = std::vector<DashboardFault>;

struct DashboardHead {
  std::string name, title;
};

// Fails with at least one fault.
[[nodiscard]] tl::expected<DashboardHead, DashboardFaults> check_dashboard(std::string_view text);

// Returns true for a name of a dashboard, a picture or a parameter: 1 to 64 of a-z, 0-9 and '-',
// the first not '-'.
[[nodiscard]] bool is_dashboard_name(std::string_view text);

// The text of dashboard_format.json.
[[nodiscard]] std::string_view dashboard_format();

}  // namespace fieldcast::web
