// Tests that foreign files are never quoted, whatever their content and name.
#include <gmock/gmock.h>

#include "config/files/file_reader.hpp"
#include "tests/config/support.hpp"

namespace fieldcast::config {
namespace {

using testing::HasSubstr;
using testing::Not;

const std::map<std::string, std::string>& strangers() {
  static const std::map<std::string, std::string> all{
      {"shadow", "root:$6$hidden$hidden:19000:0:99999:7:::\nbridge:$6$hidden:19000::::::\n"},
      {"password", "hidden horse battery staple\n"},
      {"password-with-colon", "hidden: horse\n"},
      {"key", "-----BEGIN PRIVATE KEY-----\nhidden\n-----END PRIVATE KEY-----\n"},
      {"key-behind-a-key", "bridge: b\n-----BEGIN PRIVATE KEY-----\nhidden\n"},
      {"environment", "PGPASSWORD=hidden\nexport bridge=hidden\n"},
      {"pgpass", "10.0.0.1:5432:plant:anna:hidden\n"},
      {"binary", std::string("\x7F"
                             "ELF\0\1\2hidden",
                             12)},
      {"latin1", "hidden\xE4\n"},
      {"utf16", std::string("\xFF\xFEh\0i\0d\0d\0e\0n\0", 14)},
      {"nested", "services:\n  bridge: hidden\n  buses: hidden\n"},
      {"json", R"({ "token": "hidden" })"},
      {"list", "- hidden\n- bridge: hidden\n"},
      {"tag", "!hidden hidden\n"},
      {"open-quote", "\"hidden\n"},
      {"columns", "user;hidden\nhidden;1\n"},
      {"long", std::string(1'000'000, 'h') + "idden"},
  };
  return all;
}

FileReader with(const std::string& text) {
  return {[text](const std::string&) -> tl::expected<std::string, FileError> { return text; },
          [](const std::string&) { return std::vector<std::string>{}; }};
}

TEST(Recognition, AFileThatIsNotAConfigurationIsNotQuoted) {
  for (const auto& [name, text] : strangers()) {
    const auto loaded = load_text(text, "x.yaml", with(text));
    EXPECT_THAT(faults_of(loaded), testing::StartsWith("x.yaml:1:1: this is no Fieldcast config"))
        << name;
    EXPECT_THAT(faults_of(loaded), Not(HasSubstr("hidden"))) << name;
  }
}

TEST(Recognition, AFileThatIsNotAChannelListTemplateOrDeclarationIsNotQuoted) {
  const auto device = [](const std::string& keys) {
    return "bridge: b\nbuses:\n  - { name: x, port: { serial: /dev/ttyS0 }, devices: [ { name: d, "
           "address: 1, " +
           keys + " } ] }\n";
  };
  for (const auto& [name, text] : strangers()) {
    for (const auto& [keys, said] :
         {std::pair{"protocol: modbus-rtu, channels: ../secret", "this is no channel list"},
          std::pair{"protocol: modbus-rtu, template: secret", "this is no device template"},
          std::pair{"protocol: secret, channels: []", "this is no declaration of a protocol"}}) {
      const auto loaded = load_text(device(keys), "x.yaml", with(text));
      EXPECT_THAT(faults_of(loaded), HasSubstr(said)) << name << '\n' << keys;
      EXPECT_THAT(faults_of(loaded), Not(HasSubstr("hidden"))) << name << '\n' << keys;
    }
    const auto declaration = load_declaration_text(text, "x.yaml");
    ASSERT_FALSE(declaration) << name;
    EXPECT_THAT(to_text(declaration.error()), Not(HasSubstr("hidden"))) << name;
  }
}

TEST(Recognition, WhatIsMeantForTheBridgeIsReadInEverySpelling) {
  for (const char* text :
       {"bridge: b", "buses:",
        "\xEF\xBB\xBF"
        "bridge: b\n",
        "# a plant\n\n---\nbridge: b\n", "  bridge: b\n  buses: []\n", "\"bridge\": b",
        "'bridge' : b", "dds: {}\r\nbuses: []\r\n", "{ bridge: b }", R"({"bridge":"b","buses":[]})",
        "{\n  log: {},\n  bridge: b }", "--- { bridge: b }"})
    EXPECT_TRUE(is_configuration(text)) << text;
}

}  // namespace
}  // namespace fieldcast::config
