#include "tests/config/json_schema.hpp"

#include <algorithm>
#include <cstdlib>
#include <regex>
#include <stdexcept>

namespace fieldcast::config {
namespace {

using nlohmann::json;

bool is_type(const json& value, const std::string& type) {
  if (type == "object") return value.is_object();
  if (type == "array") return value.is_array();
  if (type == "string") return value.is_string();
  if (type == "boolean") return value.is_boolean();
  if (type == "null") return value.is_null();
  if (type == "number") return value.is_number();
  if (type == "integer") return value.is_number_integer();
  throw std::runtime_error("type " + type);
}

std::string misfit_types(const json& value, const json& types) {
  if (types.is_string()) return is_type(value, types) ? "" : "is no " + types.get<std::string>();
  for (const auto& type : types) {
    if (is_type(value, type)) return "";
  }
  return "is none of " + types.dump();
}

std::size_t fitting(const json& value, const json& alternatives, const json& root,
                    const std::string& path) {
  std::size_t count = 0;
  for (const auto& alternative : alternatives)
    count += misfit(value, alternative, root, path).empty() ? 1 : 0;
  return count;
}

std::string misfit_properties(const json& value, const json& schema, const json& root,
                              const std::string& path) {
  const json none = json::object();
  const auto& properties = schema.contains("properties") ? schema["properties"] : none;
  for (const auto& [key, inner] : value.items()) {
    std::string reason;
    if (properties.contains(key))
      reason = misfit(inner, properties[key], root, path + '/' + key);
    else if (!schema.contains("additionalProperties"))
      continue;
    else if (schema["additionalProperties"] == false)
      reason = path + ": unknown key '" + key + "'";
    else
      reason = misfit(inner, schema["additionalProperties"], root, path + '/' + key);
    if (!reason.empty()) return reason;
  }
  return "";
}

std::string misfit_keyword(const std::string& keyword, const json& rule, const json& value) {
  if (keyword == "type") return misfit_types(value, rule);
  if (keyword == "enum")
    return std::find(rule.begin(), rule.end(), value) != rule.end() ? ""
                                                                    : "is none of " + rule.dump();
  if (keyword == "required") {
    for (const auto& key : rule) {
      if (value.is_object() && !value.contains(key)) return "lacks " + key.get<std::string>();
    }
    return "";
  }
  const double limit = rule.is_number() ? rule.get<double>() : 0;
  const auto size = static_cast<double>(
      value.is_string() ? value.get_ref<const std::string&>().size() : value.size());
  if (keyword == "minimum") return value.is_number() && value < rule ? "is too small" : "";
  if (keyword == "maximum") return value.is_number() && value > rule ? "is too large" : "";
  if (keyword == "minItems") return value.is_array() && size < limit ? "has too few items" : "";
  if (keyword == "maxItems") return value.is_array() && size > limit ? "has too many items" : "";
  if (keyword == "maxProperties")
    return value.is_object() && size > limit ? "has too many keys" : "";
  if (keyword == "minLength") return value.is_string() && size < limit ? "is too short" : "";
  if (keyword == "maxLength") return value.is_string() && size > limit ? "is too long" : "";
  if (keyword == "pattern") {
    if (!value.is_string()) return "";
    return std::regex_search(value.get<std::string>(), std::regex(rule.get<std::string>()))
               ? ""
               : "has another form than " + rule.dump();
  }
  throw std::runtime_error("keyword " + keyword);
}

}  // namespace

json json_of(const Node& node) {
  switch (node.kind) {
    case Kind::kNull: return nullptr;
    case Kind::kList: {
      json list = json::array();
      for (const Node* item : node.items) list.push_back(json_of(*item));
      return list;
    }
    case Kind::kMap: {
      json map = json::object();
      for (const auto& [key, value] : node.entries) map[key->text] = json_of(*value);
      return map;
    }
    case Kind::kScalar: break;
  }
  static const std::regex kInteger("[-+]?[0-9]+|0x[0-9a-fA-F]+");
  static const std::regex kNumber("[-+]?(\\.[0-9]+|[0-9]+(\\.[0-9]*)?)([eE][-+]?[0-9]+)?");
  if (node.quoted) return node.text;
  if (node.text == "true" || node.text == "false") return node.text == "true";
  if (node.text.starts_with("0x") && std::regex_match(node.text, kInteger))
    return std::stoull(node.text, nullptr, 16);
  if (std::regex_match(node.text, kInteger)) return std::stoll(node.text);
  if (std::regex_match(node.text, kNumber)) return std::strtod(node.text.c_str(), nullptr);
  return node.text;
}

std::string misfit(const json& value, const json& schema, const json& root,
                   const std::string& path) {
  for (const auto& [keyword, rule] : schema.items()) {
    std::string reason;
    if (keyword == "$schema" || keyword == "title" || keyword == "description" ||
        keyword == "$defs")
      continue;
    if (keyword == "$ref") {
      reason =
          misfit(value, root.at(json::json_pointer(rule.get<std::string>().substr(1))), root, path);
    } else if (keyword == "properties" || keyword == "additionalProperties") {
      if (value.is_object()) reason = misfit_properties(value, schema, root, path);
    } else if (keyword == "items") {
      for (std::size_t i = 0; value.is_array() && reason.empty() && i < value.size(); ++i) {
        reason = misfit(value[i], rule, root, path + '/' + std::to_string(i));
      }
    } else if (keyword == "oneOf" || keyword == "anyOf") {
      const auto count = fitting(value, rule, root, path);
      if (count == 0 || (keyword == "oneOf" && count > 1))
        reason = path + ": fits " + std::to_string(count) + " alternatives";
    } else if (reason = misfit_keyword(keyword, rule, value); !reason.empty()) {
      reason = path + ": " + value.dump().substr(0, 60) + ' ' + reason;
    }
    if (!reason.empty()) return reason;
  }
  return "";
}

}  // namespace fieldcast::config
