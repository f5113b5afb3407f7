// The allowed elements and attributes of an SVG picture, and the check of attribute values. Pure.
#pragma once

#include <string_view>

namespace fieldcast::web {

[[nodiscard]] bool is_allowed_element(std::string_view name);
// Elements whose text is shown or read aloud.
[[nodiscard]] bool has_text(std::string_view element);

// Allowed as a declaration in `style` and as an attribute.
[[nodiscard]] bool is_presentation(std::string_view name);

// Returns true if the attribute may be copied with this value. Fails for every value that could
// refer to something outside the picture.
[[nodiscard]] bool is_allowed_attribute(std::string_view name, std::string_view value);

}  // namespace fieldcast::web
