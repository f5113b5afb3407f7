// Built with Fast DDS 2.9 only: no function of 3.x is replaced. Interop.Releases tests the exchange
// with 3.1.2, which the secured announcement makes possible.
#include "bridge/dds/library/secured_announcement.hpp"

#include <dlfcn.h>
#include <gtest/gtest.h>

namespace fieldcast {
namespace {

// Resolves the symbols as the library's calls do: by name, in link order.
TEST(SecuredAnnouncement, ReplacesFunctionsOfTheLibrary) {
  offer_secured_announcements();
  for (const char* const symbol :
       {"_ZN8eprosima8fastrtps4rtps8security15SecurityManager29register_local_builtin_writerERKNS1_"
        "6GUID_tERNS2_26EndpointSecurityAttributesE",
        "_ZN8eprosima8fastrtps4rtps19RTPSParticipantImpl54pairing_remote_reader_with_local_writer_"
        "after_securityERKNS1_6GUID_tERKNS1_15ReaderProxyDataE",
        "_ZN8eprosima8fastrtps4rtps9PDPSimple24announceParticipantStateEbbRNS1_11WriteParamsE",
        "_ZN8eprosima8fastrtps4rtps9PDPSimple26notifyAboveRemoteEndpointsERKNS1_"
        "20ParticipantProxyDataE",
        "_ZN8eprosima8fastrtps4rtps9PDPSimple21removeRemoteEndpointsEPNS1_"
        "20ParticipantProxyDataE"}) {
    void* const library = ::dlsym(RTLD_NEXT, symbol);
    ASSERT_NE(library, nullptr) << "this version of Fast DDS has no " << symbol;
    EXPECT_NE(::dlsym(RTLD_DEFAULT, symbol), library) << "the library's own is called: " << symbol;
  }
}

}  // namespace
}  // namespace fieldcast
