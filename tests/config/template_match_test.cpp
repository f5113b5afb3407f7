#include "config/files/template_match.hpp"

#include <gmock/gmock.h>

namespace fieldcast::config {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

TEST(TemplateMatch, TheIdentityOfADeviceChoosesThem) {
  const auto heads = template_heads(disk_reader(), default_options());
  EXPECT_GT(heads.size(), 40u);
  const auto of = [&](std::string_view identity, std::string_view protocol = "modbus-rtu") {
    return matching_templates(identity, protocol, heads);
  };
  EXPECT_THAT(of("Siemens AG, SENTRON PAC3200, 2.1"), ElementsAre("siemens-pac3200"));
  EXPECT_THAT(of("Schneider Electric, PM5340, V1.05"), ElementsAre("schneider-pm5000"));
  EXPECT_THAT(of("CARLO GAVAZZI, EM24DINAV93XISX"), ElementsAre("carlo-gavazzi-em24"));
  EXPECT_THAT(of("Carlo Gavazzi, EM24DINAV23XE1", "modbus-tcp"),
              ElementsAre("carlo-gavazzi-em24-ethernet"));
  EXPECT_THAT(of("Huawei, SUN2000"), ElementsAre("huawei-sun2000", "huawei-sun2000-storage"));
  EXPECT_THAT(of("Siemens AG, PAC3200", "s7-ppi"), IsEmpty())
      << "the template has no such protocol";
  EXPECT_THAT(of("Other, PM5340"), IsEmpty()) << "another maker";
  EXPECT_THAT(of("Siemens AG, S7-1200"), IsEmpty()) << "the maker alone";
  EXPECT_THAT(of("Chint, DTSU666H"), ElementsAre("chint-dtsu666"));
  EXPECT_THAT(of(""), IsEmpty());
}

TEST(TemplateMatch, AHeadIsReadFromTheText) {
  const auto head = template_head("x",
                                  "# Device:  Acme X100; not the Y200\r\ndescription: A meter\n"
                                  "protocols: [modbus-rtu, s7-ppi]\n");
  EXPECT_EQ(head.device, "Acme X100; not the Y200");
  EXPECT_EQ(head.description, "A meter");
  EXPECT_THAT(head.protocols, ElementsAre("modbus-rtu", "s7-ppi"));
  EXPECT_THAT(template_head("x", "protocol: dtc\n").protocols, ElementsAre("dtc"));
  EXPECT_THAT(matching_templates("Acme Y200", "modbus-rtu", {head}), IsEmpty());
}

}  // namespace
}  // namespace fieldcast::config
