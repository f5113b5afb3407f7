#include "bridge/security/documents.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <vector>

namespace fieldcast::security {
namespace {

// All domains: membership in a domain is not a matter of trust. Cyclone DDS 0.10 rejects a document
// with a domain above 230.
std::string domains() {
  return fmt::format("      <domains><id_range><min>0</min><max>{}</max></id_range></domains>\n",
                     kHighestDomain);
}

std::string head(std::string_view schema) {
  return fmt::format(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
      "<dds xmlns:xsi=\"http://www.w3.org/2001/XMLSchema-instance\" "
      "xsi:noNamespaceSchemaLocation=\"http://www.omg.org/spec/DDS-SECURITY/20170901/{}\">\n",
      schema);
}

std::string topic_rule(std::string_view expression, std::string_view data) {
  return fmt::format(
      "        <topic_rule>\n"
      "          <topic_expression>{}</topic_expression>\n"
      "          <enable_discovery_protection>true</enable_discovery_protection>\n"
      "          <enable_liveliness_protection>true</enable_liveliness_protection>\n"
      "          <enable_read_access_control>true</enable_read_access_control>\n"
      "          <enable_write_access_control>true</enable_write_access_control>\n"
      "          <metadata_protection_kind>NONE</metadata_protection_kind>\n"
      "          <data_protection_kind>{}</data_protection_kind>\n"
      "        </topic_rule>\n",
      expression, data);
}

std::string escaped(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if (c == '&') {
      out += "&amp;";
    } else if (c == '<') {
      out += "&lt;";
    } else if (c == '>') {
      out += "&gt;";
    } else {
      out += c;
    }
  }
  return out;
}

std::string criteria(std::string_view word, const std::vector<std::string_view>& topics,
                     const std::vector<std::string>& partitions) {
  if (topics.empty()) return {};
  std::string text = fmt::format("      <{}>\n        <topics>\n", word);
  for (const std::string_view topic : topics)
    text += fmt::format("          <topic>{}</topic>\n", topic);
  text += "        </topics>\n        <partitions>\n";
  for (const std::string& partition : partitions)
    text += fmt::format("          <partition>{}</partition>\n", escaped(partition));
  return text + fmt::format("        </partitions>\n      </{}>\n", word);
}

std::string allow_rule(const std::string& rules) {
  if (rules.empty()) return {};
  return fmt::format("    <allow_rule>\n{}{}    </allow_rule>\n", domains(), rules);
}

}  // namespace

std::string governance_text(Protection protection) {
  const std::string_view kind = protection == Protection::kEncrypt ? "ENCRYPT" : "SIGN";
  std::string rules;
  for (const TopicRight& right : topic_rights()) {
    if (right.by_bus) rules += topic_rule(right.topic, kind);
  }
  rules += topic_rule("*", "NONE");
  return head("omg_shared_ca_governance.xsd") +
         fmt::format(
             "  <domain_access_rules>\n    <domain_rule>\n{}"
             "      "
             "<allow_unauthenticated_participants>false</allow_unauthenticated_participants>\n"
             "      <enable_join_access_control>true</enable_join_access_control>\n"
             "      <discovery_protection_kind>{}</discovery_protection_kind>\n"
             "      <liveliness_protection_kind>{}</liveliness_protection_kind>\n"
             "      <rtps_protection_kind>{}</rtps_protection_kind>\n"
             "      <topic_access_rules>\n{}      </topic_access_rules>\n"
             "    </domain_rule>\n  </domain_access_rules>\n</dds>\n",
             domains(), kind, kind, kind, rules);
}

bool protects_messages(std::string_view governance) {
  return governance.find("<rtps_protection_kind>NONE<") == std::string_view::npos;
}

std::string permissions_text(const Grant& grant) {
  const MemberRole role = grant.member.role;
  const std::vector<std::string> all{"*"};
  // Topics limited to buses have a separate rule: Fast DDS 2.9.1 searches a partition in all
  // criteria of a rule, regardless of their topics.
  std::vector<std::string_view> writes, reads, writes_by_bus;
  for (const TopicRight& right : topic_rights()) {
    if (right.writers.has(role))
      (right.by_bus && !grant.member.buses.empty() ? writes_by_bus : writes).push_back(right.topic);
    if (right.readers.has(role)) reads.push_back(right.topic);
  }
  return head("omg_shared_ca_permissions.xsd") +
         fmt::format(
             "  <permissions>\n    <grant name=\"{}\">\n"
             "    <subject_name>{}</subject_name>\n"
             "    <validity><not_before>{}</not_before><not_after>{}</not_after></validity>\n",
             grant.member.name, escaped(grant.subject), xml_time(grant.not_before),
             xml_time(grant.not_after)) +
         allow_rule(criteria("publish", writes, all) + criteria("subscribe", reads, all)) +
         allow_rule(criteria("publish", writes_by_bus, grant.member.buses)) +
         "    <default>DENY</default>\n    </grant>\n  </permissions>\n</dds>\n";
}

std::string xml_time(UtcTime time) {
  return fmt::format("{:%Y-%m-%dT%H:%M:%S}",
                     fmt::gmtime(static_cast<std::time_t>(time.nanoseconds / 1'000'000'000)));
}

}  // namespace fieldcast::security
