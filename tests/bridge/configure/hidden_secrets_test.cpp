#include "bridge/configure/hidden_secrets.hpp"

#include <gtest/gtest.h>

namespace fieldcast::configure {
namespace {

struct Case {
  const char* text;
  const char* shown;
};

class HiddenSecrets : public testing::TestWithParam<Case> {};

TEST_P(HiddenSecrets, AreNotShownAndReturn) {
  const auto [text, shown] = GetParam();
  EXPECT_EQ(without_secrets(text), shown);
  EXPECT_EQ(with_secrets(shown, text).value(), text);
}

INSTANTIATE_TEST_SUITE_P(
    Texts, HiddenSecrets,
    testing::Values(
        Case{"bridge: b\n", "bridge: b\n"},
        Case{"store: { url: postgresql://anna:pw@db:5432/plant }",
             "store: { url: postgresql://anna:__HIDDEN__@db:5432/plant }"},
        Case{"url: 'postgresql://anna:p@w:x/y#z@db/plant'",
             "url: 'postgresql://anna:__HIDDEN__@db/plant'"},
        Case{"url: postgresql://anna@db/plant?password=pw&x=1",
             "url: postgresql://anna@db/plant?password=__HIDDEN__&x=1"},
        Case{"url: postgresql://anna@db/plant\n", "url: postgresql://anna@db/plant\n"},
        Case{"options: { password: \"pw 1\", unit: 2 }",
             "options: { password: \"__HIDDEN__\", unit: 2 }"},
        Case{"password: \"a#b,c}d\\\"e'f\" # note", "password: \"__HIDDEN__\" # note"},
        Case{"{ password: 'a''b, c', unit: 2 }", "{ password: '__HIDDEN__', unit: 2 }"},
        Case{"{ password: a#b, unit: 2 }", "{ password: __HIDDEN__, unit: 2 }"},
        Case{"password: a,b}c d # note", "password: __HIDDEN__ # note"},
        Case{"\"password\": \"a,b\"", "\"password\": \"__HIDDEN__\""},
        Case{"text: \"the password: pw\"", "text: \"the password: __HIDDEN__\""},
        Case{"url: \"postgresql://anna:p w's#x@db/plant\" # x@y",
             "url: \"postgresql://anna:__HIDDEN__@db/plant\" # x@y"},
        Case{"url: postgresql://anna:p w@db/plant # x@y",
             "url: postgresql://anna:__HIDDEN__@db/plant # x@y"},
        Case{"store: { url: 'postgresql://anna@db/plant?password=p w#x&x=1', days: 2 }",
             "store: { url: 'postgresql://anna@db/plant?password=__HIDDEN__&x=1', "
             "days: 2 }"},
        Case{"url: postgresql://anna:p@db/plant?password=q@r", "url: postgresql://anna:__HIDDEN__"},
        Case{"Passphrase: pw\nname: a\n", "Passphrase: __HIDDEN__\nname: a\n"},
        Case{"description: passwords are elsewhere\n", "description: passwords are elsewhere\n"},
        Case{"a: postgres://x:one@h/d\nb: postgres://y:two@h/d",
             "a: postgres://x:__HIDDEN__@h/d\nb: postgres://y:__HIDDEN__@h/d"}));

TEST(HiddenSecretsTest, ADraftWithoutAnyNeedsNone) {
  EXPECT_EQ(with_secrets("bridge: b", "url: postgres://x:one@h/d").value(), "bridge: b");
}

TEST(HiddenSecretsTest, AnotherNumberIsRefused) {
  EXPECT_FALSE(with_secrets("a: __HIDDEN__", "a: postgres://x:one@h/d\nb: postgres://y:two@h/d"));
  EXPECT_FALSE(with_secrets("a: __HIDDEN__\nb: __HIDDEN__", "a: postgres://x:one@h/d"));
  EXPECT_FALSE(with_secrets("a: __HIDDEN__", "a: b"));
}

// Every reader of the file would see a password that without_secrets() does not recognize.
TEST(HiddenSecretsTest, APlaceWhereThePasswordWouldBeShownIsRefused) {
  constexpr const char* kUrl = "url: \"postgres://x:one@h/d\"";
  EXPECT_EQ(with_secrets("url: \"postgres://x:__HIDDEN__@h/d\" # more", kUrl).value(),
            std::string(kUrl) + " # more");
  for (const char* draft :
       {"url: \"postgres:\\x2f/x:__HIDDEN__@h/d\"", "url: \"postgres:\\\n  //x:__HIDDEN__@h/d\"",
        "# __HIDDEN__", "a: __HIDDEN__"})
    EXPECT_FALSE(with_secrets(draft, kUrl)) << draft;
}

}  // namespace
}  // namespace fieldcast::configure
