// Resources of dashboards and their pictures: documents of the store that engineers change.
#pragma once

#include <cstddef>

namespace fieldcast::web {

// Bodies of these requests: the text of a dashboard escaped as JSON, a picture in base64.
inline constexpr std::size_t kMaxDashboardBody = 192 * 1024;
inline constexpr std::size_t kMaxPictureBody = 384 * 1024;

}  // namespace fieldcast::web
