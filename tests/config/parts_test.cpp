#include <gtest/gtest.h>

#include "config/document/scalars.hpp"
#include "config/document/suggest.hpp"
#include "config/sections/port.hpp"
#include "tests/config/support.hpp"
#include "tests/support/text_cases.hpp"

namespace fieldcast::config {
namespace {

TEST(Number, IsFiniteAndWhole) {
  EXPECT_EQ(number_from("-2.5e1"), -25.0);
  for (const auto* text : {"", "x", "1x", "1 ", " 1", "inf", "nan", "1e999", "0,1", "--1"})
    EXPECT_EQ(number_from(text), std::nullopt) << text;
  EXPECT_EQ(whole_from("0x1F"), 31);
  EXPECT_EQ(whole_from("-7"), -7);
  for (const auto* text : {"", "0x", "0x-1", "1.0", "9223372036854775808", "one"})
    EXPECT_EQ(whole_from(text), std::nullopt) << text;
}

TEST(PortText, FormatIsDataParityStop) {
  EXPECT_EQ(format_from("8N1"), (LineFormat{19200, 8, Parity::kNone, 1}));
  EXPECT_EQ(format_from("7E2"), (LineFormat{19200, 7, Parity::kEven, 2}));
  EXPECT_EQ(format_from("8O1"), (LineFormat{19200, 8, Parity::kOdd, 1}));
  for (const auto* text : {"", "8n1", "9N1", "8N3", "8N", "8N11", "8X1"})
    EXPECT_EQ(format_from(text), std::nullopt) << text;
}

TEST(PortText, LineIsAsTheProtocolsDevicesComeFromTheFactory) {
  const auto line = [](const std::string& protocol) {
    const auto loaded = load_text(
        "bridge: b\nbuses:\n  - { name: bus, port: { serial: /dev/ttyS0 }, protocol: " + protocol +
            ", devices: [ { name: d, address: 1, allow: [raw-read] } ] }\n",
        "plant.yaml", {});
    return loaded ? to_text(loaded->buses[0].port) : faults_of(loaded);
  };
  test::expect_texts(line,
                     {"modbus-rtu -> /dev/ttyS0 19200 8E1", "modbus-ascii -> /dev/ttyS0 19200 7E1",
                      "omron-hostlink -> /dev/ttyS0 9600 7E2", "s7-freeport -> /dev/ttyS0 9600 8N1",
                      "s7-ppi -> /dev/ttyS0 9600 8E1", "dtc -> /dev/ttyS0 19200 8E1",
                      "mitsubishi-fx -> /dev/ttyS0 9600 7E1"});
}

TEST(PortText, LineIsThatOfTheProtocolWhichOnlyTheDevicesName) {
  const auto line = [](const std::string& second) {
    const auto loaded = load_text(
        "bridge: b\nbuses:\n  - { name: bus, port: { serial: /dev/ttyS0 }, devices: [ { name: a, "
        "address: 1, protocol: omron-hostlink, allow: [raw-read] }, { name: b, address: 2, "
        "protocol: " +
            second + ", allow: [raw-read] } ] }\n",
        "plant.yaml", {});
    return loaded ? to_text(loaded->buses[0].port) : faults_of(loaded);
  };
  test::expect_texts(
      line, {"omron-hostlink -> /dev/ttyS0 9600 7E2", "modbus-rtu -> /dev/ttyS0 19200 8E1"});
}

TEST(PortText, EndpointIsHostAndPort) {
  EXPECT_EQ(host_port_from("10.0.0.7:502"),
            (std::pair<std::string, std::uint16_t>{"10.0.0.7", 502}));
  EXPECT_EQ(host_port_from("plc-1.local:65535"),
            (std::pair<std::string, std::uint16_t>{"plc-1.local", 65535}));
  EXPECT_EQ(host_port_from("[::1]:1"), (std::pair<std::string, std::uint16_t>{"::1", 1}));
  for (const auto* text : {"", ":", "h", "h:", ":502", "h:0", "h:65536", "h:-1", "h:0x10", "h:5x",
                           "::1:502", "[]:502", "a b:502", "a/b:502"}) {
    EXPECT_EQ(host_port_from(text), std::nullopt) << text;
  }
}

TEST(Suggestion, IsAHabitANearMissOrABeginning) {
  static constexpr std::string_view kKeys[] = {"refresh", "float32", "description", "at"};
  EXPECT_EQ(closest("period", kKeys), "refresh");
  EXPECT_EQ(closest("refersh", kKeys), "refresh");
  EXPECT_EQ(closest("Refresh", kKeys), "refresh");
  EXPECT_EQ(closest("float", kKeys), "float32");
  EXPECT_EQ(closest("address", kKeys), "at");
  EXPECT_EQ(closest("zebra", kKeys), "");
  EXPECT_EQ(closest("", kKeys), "");
}

TEST(Files, AreRelativeToTheFileThatNamesThem) {
  const auto reader = texts({{"plants/devices/kind.yaml", "channels: lists/kind.csv\n"},
                             {"plants/devices/lists/kind.csv", "name,at\na,coil:1\n"},
                             {"plants/own.csv", "name,at\nb,coil:2\n"}});
  const auto loaded = load_text(
      "bridge: b\nbuses:\n  - name: bus\n    port: { serial: /dev/ttyS0 }\n    protocol: "
      "modbus-rtu\n    devices:\n"
      "      - { name: d, address: 1, template: kind, channels: own.csv }\n",
      "plants/line.yaml", reader);
  ASSERT_TRUE(loaded) << faults_of(loaded);
  ASSERT_EQ(loaded->buses[0].devices[0].channels.size(), 2u);
  EXPECT_EQ(loaded->buses[0].devices[0].channels[0].name, "a");
  EXPECT_EQ(loaded->buses[0].devices[0].channels[1].name, "b");
}

TEST(Files, TheFolderBesideTheConfigurationComesBeforeTheShippedTemplates) {
  const std::string text =
      "bridge: b\nbuses:\n  - name: bus\n    port: { serial: /dev/ttyS0 }\n    protocol: "
      "modbus-rtu\n    devices:\n"
      "      - { name: d, address: 1, template: kind }\n";
  const std::string shipped = "channels: [ { name: shipped, at: \"coil:1\" } ]\n",
                    own = "channels: [ { name: own, at: \"coil:1\" } ]\n";
  const LoadOptions options{{"/share/first", "/share/second/"}};
  const auto name = [&](const FileReader& reader) {
    return load_text(text, "/etc/line.yaml", reader, options)->buses[0].devices[0].channels[0].name;
  };
  EXPECT_EQ(name(texts({{"/share/second/kind.yaml", shipped}})), "shipped");
  EXPECT_EQ(name(texts({{"/share/second/kind.yaml", shipped}, {"/etc/devices/kind.yaml", own}})),
            "own");
}

TEST(Files, WhatIsNotARegularFileIsAFault) {
  EXPECT_EQ(faults_of(load_file("/dev/zero")), "/dev/zero:1:1: the file cannot be read\n");
  EXPECT_EQ(faults_of(load_file("/")), "/:1:1: the file cannot be read\n");
  EXPECT_EQ(faults_of(load_file("/no/such.yaml")), "/no/such.yaml:1:1: the file does not exist\n");
}

TEST(Files, ATemplateThatCannotBeReadIsNotSuggestedInItsPlace) {
  const FileReader reader{[](const std::string&) { return tl::unexpected(FileError::kUnreadable); },
                          [](const std::string&) { return std::vector<std::string>{"kind.yaml"}; }};
  const std::string text =
      "bridge: b\nbuses:\n  - name: bus\n    port: { serial: /dev/ttyS0 }\n    protocol: "
      "modbus-rtu\n    devices:\n"
      "      - { name: d, address: 1, template: kind }\n";
  const std::string faults = faults_of(load_text(text, "/etc/line.yaml", reader));
  EXPECT_TRUE(
      faults.ends_with("template 'kind' cannot be read; allowed: a regular file that the user of "
                       "this program may read\n"))
      << faults;
}

TEST(Files, SmallWindowsHabitsAreTolerated) {
  std::string text =
      "\xEF\xBB\xBF" + plant("          - { name: a, at: \"holding:1\", type: int16 }\n");
  std::string crlf;
  for (const char c : text) crlf += c == '\n' ? std::string("\r\n") : std::string(1, c);
  EXPECT_EQ(faults_of(load_text(crlf, "plant.yaml", {})), "");
}

TEST(Files, EachSignThatLibyamlTreatsOtherwiseIsReplacedAlone) {
  for (const auto* text :
       {"# a\rb\nc: d", "# a\u0085b\nc: d", "# a\u2028b\nc: d", "# a\u2029b\nc: d",
        "# a\uFFFE\nc: d", "# a\uFFFF\nc: d", "\t# a\nc: d", "c: d\r\n"}) {
    FaultList faults;
    const auto document = parse_yaml(Source{"plant.yaml", text, 0}, faults);
    ASSERT_TRUE(document->root != nullptr && faults.empty()) << text;
    ASSERT_EQ(document->root->entries.size(), 1u) << text;
    EXPECT_EQ(document->root->entries.begin()->value->text, "d") << text;
  }
}

TEST(Places, AreThoseOfTheValueOrOfTheMapWithoutTheKey) {
  Places places;
  EXPECT_EQ(places.at("dds.security"), "");
  LoadOptions options;
  options.places = &places;
  const std::string text =
      "bridge: b\n"
      "dds: { domain: 3, security: ca }\n"
      "buses:\n"
      "  - name: bus\n"
      "    port: { serial: /dev/ttyS0 }\n"
      "    protocol: modbus-rtu\n"
      "    devices: [ { name: d, address: 1, allow: [raw-read] } ]\n"
      "    capture: { folder: \"\xc3\xa4\", files: 2 }\n";
  ASSERT_EQ(faults_of(load_text(text, "plant.yaml", {}, options)), "");
  EXPECT_EQ(places.at("dds.security"), "plant.yaml:2:29");
  EXPECT_EQ(places.at("dds.interfaces"), "plant.yaml:2:6");
  EXPECT_EQ(places.at("buses.0.capture.folder"), "plant.yaml:8:24");
  EXPECT_EQ(places.at("buses.0.capture.files"), "plant.yaml:8:36");
  EXPECT_EQ(places.at("buses.1.capture.folder"), "plant.yaml:4:3");
  EXPECT_EQ(places.at("program.modules"), "plant.yaml:1:1");
}

TEST(Faults, SpeakInOneLine) {
  EXPECT_EQ(to_text(Fault{"a.yaml", 3, 7, "what", "this, that", "this"}),
            "a.yaml:3:7: what; allowed: this, that; did you mean this?");
  EXPECT_EQ(to_text(Fault{"a.yaml", 3, 7, "what", "", ""}), "a.yaml:3:7: what");
}

}  // namespace
}  // namespace fieldcast::config
