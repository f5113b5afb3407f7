// Fuzzes what an engineer uploads: the text of a dashboard and a picture. A valid dashboard has a
// name; a sanitised SVG passes the sanitiser unchanged and contains no element that runs or loads
// anything.
#include <nlohmann/json.hpp>

#include "core/base/bytes.hpp"
#include "tests/fuzz/fuzz.hpp"
#include "tools/station/dashboard/dashboard_document.hpp"
#include "tools/station/dashboard/picture.hpp"
#include "tools/station/dashboard/svg_sanitizer.hpp"

namespace fieldcast::web {
namespace {

using fuzz::require;

void run_picture(std::string_view bytes) {
  const auto picture = check_picture(bytes);
  if (!picture) return require(!picture.error().empty());
  require(picture->width > 0 && picture->height > 0);
  require(picture->content.size() <= kMaxPictureBytes);
  if (picture->type == PictureType::kPng) return require(picture->content == bytes);
  const auto again = sanitized_svg(picture->content);
  require(again && again->text == picture->content && again->removed.empty());
  // Text has no '<' of its own, so each of these would be markup.
  for (const char* never : {"<script", "<foreign", "<image", "<use", "<a ", "<style", "<!", "<?"})
    require(picture->content.find(never) == std::string::npos);
}

void run_dashboard(ByteView data) {
  const std::string_view text(reinterpret_cast<const char*>(data.data()), data.size());
  const auto head = check_dashboard(text);
  if (head) {
    require(is_dashboard_name(head->name) && nlohmann::json::accept(text));
  } else {
    require(!head.error().empty() && head.error().size() <= kMaxDashboardFaults);
    for (const DashboardFault& fault : head.error()) require(!fault.allowed.empty());
  }
  run_picture(text);
}

}  // namespace
}  // namespace fieldcast::web

FIELDCAST_FUZZ_TARGET(fieldcast::web::run_dashboard)
