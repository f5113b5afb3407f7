#include "tools/station/dashboard/svg_sanitizer.hpp"

#include <fmt/format.h>
#include <tinyxml2.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <optional>

#include "core/base/message_text.hpp"
#include "tools/station/dashboard/svg_values.hpp"

namespace fieldcast::web {

namespace {

constexpr std::size_t kShownName = 60;  // bytes of a name in a message
constexpr double kMaxSide = 100'000;

std::string encoded(std::string_view text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '<': out += "&lt;"; break;
      case '>': out += "&gt;"; break;
      case '&': out += "&amp;"; break;
      case '"': out += "&quot;"; break;
      case '\'': out += "&#39;"; break;
      default: out += c;
    }
  }
  return out;
}

using Attributes = std::map<std::string, std::string>;

class Writer {
 public:
  void write(const tinyxml2::XMLElement& element, int depth, bool in_clip);
  [[nodiscard]] const std::string& fault() const { return fault_; }

  SanitizedSvg result;

 private:
  void remove(std::string what) {
    if (result.removed.size() < kMaxRemoved) result.removed.insert(std::move(what));
  }
  void put(Attributes& kept, const std::string& name, const std::string& value, bool in_clip);
  void put_style(Attributes& kept, std::string_view style, bool in_clip);
  [[nodiscard]] Attributes attributes_of(const tinyxml2::XMLElement& element, bool in_clip);
  void write_children(const tinyxml2::XMLElement& element, int depth, bool in_clip);

  std::size_t elements_ = 0, references_ = 0;
  std::string fault_;
};

void Writer::put(Attributes& kept, const std::string& name, const std::string& value,
                 bool in_clip) {
  // A clip path that refers to a clip path would multiply the work of drawing it.
  const bool repeats = in_clip && name == "clip-path";
  const bool surplus = name == "href" && ++references_ > kMaxSvgReferences;
  if (!repeats && !surplus && is_allowed_attribute(name, value))
    kept.insert_or_assign(name, value);
  else
    remove(printable(name, kShownName));
}

// The declarations become attributes, checked as these.
void Writer::put_style(Attributes& kept, std::string_view style, bool in_clip) {
  while (!style.empty()) {
    const std::string_view one = style.substr(0, style.find(';'));
    style.remove_prefix(std::min(style.size(), one.size() + 1));
    const std::size_t colon = one.find(':');
    const std::size_t start = one.find_first_not_of(" \t\r\n");
    if (start == one.npos) continue;
    const std::string name(one.substr(start, one.find_last_not_of(" \t\r\n:", colon) + 1 - start));
    if (colon != one.npos && is_presentation(name))
      put(kept, name, std::string(one.substr(colon + 1)), in_clip);
    else
      remove("style " + printable(name, kShownName));
  }
}

Attributes Writer::attributes_of(const tinyxml2::XMLElement& element, bool in_clip) {
  Attributes kept;
  const char* style = nullptr;
  for (const auto* each = element.FirstAttribute(); each != nullptr; each = each->Next()) {
    const std::string name = each->Name();
    if (name == "style")
      style = each->Value();
    else if (name == "xlink:href")
      put(kept, "href", each->Value(), in_clip);
    else if (!name.starts_with("xmlns") && name != "version")
      put(kept, name, each->Value(), in_clip);
  }
  if (style != nullptr) put_style(kept, style, in_clip);
  return kept;
}

void Writer::write(const tinyxml2::XMLElement& element, int depth, bool in_clip) {
  const std::string name = element.Name();
  if (!is_allowed_element(name)) return remove(printable(name, kShownName));
  if (++elements_ > kMaxSvgElements || depth > kMaxSvgDepth) {
    fault_ = fmt::format("line {}: at most {} elements and {} levels are allowed",
                         element.GetLineNum(), kMaxSvgElements, kMaxSvgDepth);
    return;
  }
  result.text += '<' + name;
  if (depth == 0) result.text += " xmlns=\"http://www.w3.org/2000/svg\"";
  const bool clips = in_clip || name == "clipPath";
  for (const auto& [key, value] : attributes_of(element, clips))
    result.text += fmt::format(" {}=\"{}\"", key, encoded(value));
  result.text += '>';
  write_children(element, depth, clips);
  result.text += "</" + name + '>';
}

void Writer::write_children(const tinyxml2::XMLElement& element, int depth, bool in_clip) {
  for (const auto* child = element.FirstChild(); child != nullptr && fault_.empty();
       child = child->NextSibling()) {
    if (const auto* inner = child->ToElement())
      write(*inner, depth + 1, in_clip);
    else if (const auto* text = child->ToText(); text != nullptr && has_text(element.Name()))
      result.text += encoded(printable(text->Value()));
  }
}

std::vector<double> numbers_of(std::string_view text) {
  std::vector<double> numbers;
  const char* at = text.data();
  const char* const end = at + text.size();
  while (at != end && numbers.size() < 5) {
    if (*at == ' ' || *at == ',' || *at == '\n' || *at == '\t' || *at == '\r') {
      ++at;
      continue;
    }
    double number = 0;
    const auto read = std::from_chars(at, end, number);
    if (read.ec != std::errc{}) return {};
    numbers.push_back(number);
    at = read.ptr;
  }
  return numbers;
}

// "120", "120px", "31.5mm": the ratio of both sides matters, not the unit.
double side_of(const tinyxml2::XMLElement& root, const char* name) {
  const char* text = root.Attribute(name);
  if (text == nullptr || std::string_view(text).ends_with('%')) return 0;
  double number = 0;
  (void)std::from_chars(text, text + std::string_view(text).size(), number);
  return number;
}

bool is_side(double side) { return std::isfinite(side) && side > 0 && side <= kMaxSide; }

std::optional<std::pair<double, double>> size_of(const tinyxml2::XMLElement& root) {
  if (const char* box = root.Attribute("viewBox")) {
    const std::vector<double> sides = numbers_of(box);
    if (sides.size() != 4 || !is_side(sides[2]) || !is_side(sides[3])) return std::nullopt;
    return std::pair(sides[2], sides[3]);
  }
  const double width = side_of(root, "width"), height = side_of(root, "height");
  if (!is_side(width) || !is_side(height)) return std::nullopt;
  return std::pair(width, height);
}

}  // namespace

tl::expected<SanitizedSvg, std::string> sanitized_svg(std::string_view text) {
  if (!is_utf8(text) || text.find('\0') != text.npos)
    return tl::make_unexpected("the SVG is not UTF-8; save it with this encoding");
  if (text.find("<!ENTITY") != text.npos)
    return tl::make_unexpected(
        "the SVG declares entities, which are not allowed; save it as plain "
        "SVG");
  tinyxml2::XMLDocument document;
  if (document.Parse(text.data(), text.size()) != tinyxml2::XML_SUCCESS)
    return tl::make_unexpected(
        fmt::format("line {}: the SVG is not well-formed XML", document.ErrorLineNum()));
  const tinyxml2::XMLElement* const root = document.RootElement();
  if (root == nullptr || std::string_view(root->Name()) != "svg")
    return tl::make_unexpected("the document is not an SVG; its first element must be <svg>");
  const auto size = size_of(*root);
  if (!size)
    return tl::make_unexpected(fmt::format(
        "the SVG has no size; give it a viewBox, or width and height, each above 0 and at most {}",
        kMaxSide));
  Writer writer;
  writer.write(*root, 0, false);
  if (!writer.fault().empty()) return tl::make_unexpected(writer.fault());
  writer.result.width = size->first;
  writer.result.height = size->second;
  return std::move(writer.result);
}

}  // namespace fieldcast::web
