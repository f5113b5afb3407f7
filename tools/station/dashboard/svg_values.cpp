#include "tools/station/dashboard/svg_values.hpp"

#include <algorithm>
#include <cctype>
#include <string>

namespace fieldcast::web {

namespace {

constexpr std::string_view kElements[] = {
    "svg",    "g",        "defs",           "title",          "desc",     "path", "rect",
    "circle", "line",     "ellipse",        "polygon",        "polyline", "text", "tspan",
    "stop",   "clipPath", "linearGradient", "radialGradient", "switch",
};
constexpr std::string_view kTextElements[] = {"text", "tspan", "title", "desc"};

// Properties of SVG 1.1 and 2 that change only how an element is drawn.
constexpr std::string_view kPresentation[] = {
    "fill",
    "fill-opacity",
    "fill-rule",
    "stroke",
    "stroke-width",
    "stroke-opacity",
    "stroke-linecap",
    "stroke-linejoin",
    "stroke-miterlimit",
    "stroke-dasharray",
    "stroke-dashoffset",
    "opacity",
    "color",
    "display",
    "visibility",
    "stop-color",
    "stop-opacity",
    "font-family",
    "font-size",
    "font-weight",
    "font-style",
    "text-anchor",
    "dominant-baseline",
    "letter-spacing",
    "word-spacing",
    "clip-path",
    "clip-rule",
    "paint-order",
    "vector-effect",
    "shape-rendering",
    "text-rendering",
    "transform-origin",
};
constexpr std::string_view kGeometry[] = {
    "x",
    "y",
    "x1",
    "y1",
    "x2",
    "y2",
    "cx",
    "cy",
    "r",
    "rx",
    "ry",
    "fx",
    "fy",
    "dx",
    "dy",
    "width",
    "height",
    "viewBox",
    "preserveAspectRatio",
    "d",
    "points",
    "pathLength",
    "transform",
    "rotate",
    "textLength",
    "lengthAdjust",
    "offset",
    "gradientUnits",
    "gradientTransform",
    "spreadMethod",
    "clipPathUnits",
};
constexpr std::string_view kFunctions[] = {"matrix", "translate", "scale", "rotate", "skewX",
                                           "skewY",  "rgb",       "rgba",  "hsl",    "hsla"};

template <class Table>
bool contains(const Table& table, std::string_view name) {
  return std::ranges::find(table, name) != std::end(table);
}

bool is_letter(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0; }

bool is_id(std::string_view text) {
  return !text.empty() && text.size() <= 100 && std::ranges::all_of(text, [](char c) {
    return is_letter(c) || c == '-' || c == '_' || c == '.';
  });
}

// "#name": an element of the same picture.
bool is_local(std::string_view text) { return text.starts_with('#') && is_id(text.substr(1)); }

std::string_view trimmed(std::string_view text) {
  const auto blank = [](char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; };
  while (!text.empty() && blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && blank(text.back())) text.remove_suffix(1);
  return text;
}

// url(#name), alone.
bool is_local_url(std::string_view value) {
  value = trimmed(value);
  return value.starts_with("url(") && value.ends_with(')') &&
         is_local(trimmed(value.substr(4, value.size() - 5)));
}

// Without ':', '/', '\', '@', ';', '<' and '&', no address, no escape and no rule can be written.
bool is_plain(std::string_view value) {
  static constexpr std::string_view kMarks = " \t\r\n#%.,()+-_'\"";
  return std::ranges::all_of(
      value, [](char c) { return is_letter(c) || kMarks.find(c) != std::string_view::npos; });
}

bool has_only_known_functions(std::string_view value) {
  for (std::size_t open = 0; (open = value.find('(', open)) != value.npos; ++open) {
    const std::string_view before = trimmed(value.substr(0, open));
    std::size_t start = before.size();
    while (start > 0 && (is_letter(before[start - 1]) || before[start - 1] == '-')) --start;
    if (!contains(kFunctions, before.substr(start))) return false;
  }
  return true;
}

}  // namespace

bool is_allowed_element(std::string_view name) { return contains(kElements, name); }
bool has_text(std::string_view element) { return contains(kTextElements, element); }
bool is_presentation(std::string_view name) { return contains(kPresentation, name); }

bool is_allowed_attribute(std::string_view name, std::string_view value) {
  if (name == "id") return is_id(value);
  if (name == "href") return is_local(value);  // of a gradient
  if (!is_presentation(name) && !contains(kGeometry, name)) return false;
  if (!is_plain(value)) return false;
  return is_local_url(value) || has_only_known_functions(value);
}

}  // namespace fieldcast::web
