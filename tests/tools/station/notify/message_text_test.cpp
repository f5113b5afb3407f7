#include "tools/station/notify/message_text.hpp"

#include <gmock/gmock.h>
#include <sodium.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "tools/station/notify/delivery.hpp"
#include "tools/station/notify/message_id.hpp"

namespace fieldcast::web {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::Not;
using testing::SizeIs;

constexpr UtcTime kNow{1'790'000'000'000'000'000};

NotifySpec spec() {
  NotifySpec made;
  made.link = "https://station.plant";
  made.targets = {{.name = "crew", .mail = {"ann@plant.example", "bob@plant.example"}},
                  {.name = "chat"}};
  return made;
}

NotifyMessage message(const std::string& channel = "level", const std::string& target = "crew") {
  return {.id = message_id({"a"}),
          .rule = "night",
          .target = target,
          .at = kNow,
          .alarm = {"press-shop", "press-1", channel, LimitKind::kHighHigh},
          .status = {.priority = AlarmPriority::kCritical,
                     .stage = AlarmStage::kUnacknowledged,
                     .active = true,
                     .value = 39.5,
                     .raised_at = kNow},
          .number = 1};
}

std::string decoded(std::string_view base64) {
  std::string out(base64.size(), '\0');
  std::size_t size = 0;
  EXPECT_EQ(
      sodium_base642bin(reinterpret_cast<unsigned char*>(out.data()), out.size(), base64.data(),
                        base64.size(), "\r\n", &size, nullptr, sodium_base64_VARIANT_ORIGINAL),
      0);
  out.resize(size);
  return out;
}

struct Mail {
  std::vector<std::string> headers;  // without the line end; a folded header is several lines
  std::string body;
};
Mail parsed(const std::string& mail) {
  const std::size_t end = mail.find("\r\n\r\n");
  EXPECT_NE(end, mail.npos);
  Mail found;
  for (std::size_t at = 0; at < end;) {
    const std::size_t next = mail.find("\r\n", at);
    found.headers.push_back(mail.substr(at, next - at));
    at = next + 2;
  }
  found.body = decoded(std::string_view(mail).substr(end + 4));
  return found;
}

std::string mail_of(const NotifyMessage& from) {
  return mail_text(rows_of(from, spec(), "hall").at(0), "station@plant.example");
}

TEST(MessageText, AMailHasARowForEachRecipientWithAnIdOfItsOwn) {
  const auto rows = rows_of(message(), spec(), "hall");
  ASSERT_THAT(rows, SizeIs(2));
  EXPECT_EQ(rows[0].recipient, "ann@plant.example");
  EXPECT_EQ(rows[1].recipient, "bob@plant.example");
  EXPECT_NE(rows[0].id, rows[1].id);
  EXPECT_EQ(rows[0], rows_of(message(), spec(), "hall")[0]);
  EXPECT_THAT(rows_of(message("level", "removed"), spec(), "hall"), SizeIs(0));
}

TEST(MessageText, AMailNamesTheAlarmAndItsLink) {
  const Mail mail = parsed(mail_of(message()));
  EXPECT_THAT(mail.headers,
              testing::IsSupersetOf({"From: <station@plant.example>", "To: <ann@plant.example>",
                                     "Subject: ALARM critical: press-shop/press-1/level high-high "
                                     "= 39.5",
                                     "Date: Mon, 21 Sep 2026 14:13:20 +0000"}));
  EXPECT_THAT(mail.body, HasSubstr("Value: 39.5\n"));
  EXPECT_THAT(mail.body,
              HasSubstr("https://station.plant/#/alarms?alarm=press-shop%2Fpress-1%2Flevel%2F"
                        "high-high\n"));
}

// A program in the domain chooses the names. None may add a header or end the body.
TEST(MessageText, NamesCannotAddHeaders) {
  for (const std::string evil :
       {"x\r\nBcc: eve@evil.example", "x\nBcc: eve@evil.example", "x\r\n\r\nbody\r\n.\r\n",
        "\r\n.\r\nMAIL FROM:<e@e>", "=?UTF-8?B?QmNj?=", "\xE2\x80\xAE evil", "\xFF\xFE"}) {
    const std::string text = mail_of(message(evil));
    const Mail mail = parsed(text);
    EXPECT_THAT(mail.headers, Not(testing::Contains(testing::StartsWith("Bcc"))));
    EXPECT_THAT(text, Not(HasSubstr("\r\n.\r\n")));
    EXPECT_EQ(std::count(text.begin(), text.end(), '\n'),
              std::count(text.begin(), text.end(), '\r'));
    for (const unsigned char c : text)
      EXPECT_TRUE(c == '\r' || c == '\n' || (c >= ' ' && c < 0x7F));
    for (const std::string& header : mail.headers) EXPECT_LE(header.size(), 100u) << header;
    const json body = json::parse(rows_of(message(evil), spec(), "hall")[0].json);
    EXPECT_EQ(body["bus"], "press-shop");
  }
}

TEST(MessageText, AHeaderOutsideAsciiIsEncodedInWholeCharacters) {
  EXPECT_EQ(header_text("plain"), "plain");
  EXPECT_EQ(header_text("温度"), "=?UTF-8?B?5rip5bqm?=");
  std::string text;
  for (int i = 0; i < 40; ++i) text += "温度";
  const std::string header = header_text(text);
  std::string back;
  std::size_t words = 0;
  for (std::size_t at = 0; (at = header.find("=?UTF-8?B?", at)) != header.npos; ++words) {
    const std::size_t end = header.find("?=", at + 10);
    EXPECT_LE(end + 2 - at, 75u);
    const std::string part = decoded(header.substr(at + 10, end - at - 10));
    EXPECT_EQ(part.size() % 3, 0u) << "a character of three bytes was cut";
    back += part;
    at = end;
  }
  EXPECT_EQ(back, text);
  EXPECT_GT(words, 4u);
}

TEST(MessageText, OversizedTextsAreCut) {
  const std::string text = mail_of(message(std::string(1'000'000, 'x')));
  EXPECT_LT(text.size(), 5'000u);
  NotifyMessage digest = message();
  digest.kind = NotifyKind::kDigest;
  digest.lines = std::string(1'000'000, 'x') + '\n';
  EXPECT_LT(mail_of(digest).size(), 100'000u);
}

TEST(MessageText, AWebhookHasOneRowAndItsJson) {
  const auto rows = rows_of(message("level", "chat"), spec(), "hall");
  ASSERT_THAT(rows, SizeIs(1));
  const json body = json::parse(rows[0].json);
  EXPECT_EQ(body["id"], rows[0].id);
  EXPECT_EQ(body["kind"], "raised");
  EXPECT_EQ(body["station"], "hall");
  EXPECT_EQ(body["limit"], "high-high");
  EXPECT_EQ(body["priority"], "critical");
  EXPECT_EQ(body["value"], 39.5);
  EXPECT_EQ(body["raised_ms"], 1'790'000'000'000.0);
  EXPECT_EQ(body["cleared_ms"], nullptr);
}

TEST(MessageText, ADigestHasItsLines) {
  NotifyMessage digest = message("level", "chat");
  digest.kind = NotifyKind::kDigest;
  digest.lines = "one\ntwo\n";
  digest.more = 7;
  const Notification row = rows_of(digest, spec(), "hall").at(0);
  EXPECT_EQ(row.subject, "ALARMS: 9 more messages of hall");
  EXPECT_THAT(row.text, HasSubstr("one\ntwo\nand 7 more\n"));
  EXPECT_EQ(json::parse(row.json)["more"], 7);
}

TEST(MessageText, AnAttachmentIsAPartOfTheMail) {
  Notification row = rows_of(message(), spec(), "hall").at(0);
  row.text = "See the file.\n";
  row.attachment_name = "energy_2026-11-28.xlsx";
  const std::string bytes(300, '\x80');
  row.attachment = base64(bytes);
  const std::string mail = mail_text(row, "station@plant.example");
  const std::string boundary = "--fieldcast-" + row.id + "\r\n";
  EXPECT_THAT(mail, HasSubstr("Content-Type: multipart/mixed; boundary=\"fieldcast-" + row.id +
                              "\"\r\n\r\n" + boundary + "Content-Type: text/plain"));
  EXPECT_THAT(mail, HasSubstr("filename=\"energy_2026-11-28.xlsx\"\r\n"));
  const std::size_t first = mail.find("\r\n\r\n", mail.find(boundary)) + 4;
  const std::size_t second = mail.find("\r\n\r\n", first) + 4;
  EXPECT_EQ(decoded(mail.substr(first, mail.find("--", first) - first)), row.text);
  EXPECT_EQ(decoded(mail.substr(second, mail.find("--", second) - second)), bytes);
  EXPECT_TRUE(mail.ends_with("\r\n--fieldcast-" + row.id + "--\r\n"));
  for (std::size_t at = 0, end = 0; (end = mail.find("\r\n", at)) != mail.npos; at = end + 2)
    EXPECT_LE(end - at, 100u);
}

// RFC 4231, test case 2.
TEST(Delivery, TheSignatureIsHmacSha256) {
  EXPECT_EQ(signature_of("Jefe", "what do ya want for nothing?"),
            "sha256=5bdcc146bf60754e6a042426089575c75a003f089d2739839dec58b964ec3843");
}

TEST(MessageId, DependsOnEachPart) {
  EXPECT_EQ(message_id({"a", "b"}), message_id({"a", "b"}));
  EXPECT_NE(message_id({"a", "b"}), message_id({"ab", ""}));
  EXPECT_NE(message_id({"a", "b"}), message_id({"a", "b", ""}));
}

}  // namespace
}  // namespace fieldcast::web
