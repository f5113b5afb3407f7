#include "bridge/dds/library/encoding_guard.hpp"

#include "bridge/dds/library/fastdds.hpp"

#if FASTDDS_VERSION_MAJOR >= 3

namespace fieldcast {
void guard_encoding() {}  // no symbol of 3.x is replaced
}  // namespace fieldcast

#else

#include <dlfcn.h>
#include <fastdds/rtps/common/CDRMessage_t.h>

#include <fastdds/rtps/common/GuidPrefix_t.hpp>
#include <vector>

namespace fieldcast {
namespace {

using eprosima::fastrtps::rtps::CDRMessage_t;
using Receivers = std::vector<eprosima::fastrtps::rtps::GuidPrefix_t>;
using Encode = bool (*)(const void* security_manager, const CDRMessage_t& message,
                        CDRMessage_t& encoded, const Receivers& receivers);

// bool SecurityManager::encode_rtps_message(const CDRMessage_t&, CDRMessage_t&,
//                                           const std::vector<GuidPrefix_t>&) const
#define ENCODE_RTPS_MESSAGE                                                                       \
  "_ZNK8eprosima8fastrtps4rtps8security15SecurityManager19encode_rtps_messageERKNS1_12CDRMessage" \
  "_tERS4_RKSt6vectorINS1_12GuidPrefix_tESaIS9_EE"

Encode library_encode() {
  static const auto found = reinterpret_cast<Encode>(::dlsym(RTLD_NEXT, ENCODE_RTPS_MESSAGE));
  return found;
}

}  // namespace

// Returns false if the message was not encoded and is not sent.
[[gnu::visibility("default")]] bool encode_rtps_message(
    const void* security_manager, const CDRMessage_t& message, CDRMessage_t& encoded,
    const Receivers& receivers) __asm__(ENCODE_RTPS_MESSAGE);

bool encode_rtps_message(const void* security_manager, const CDRMessage_t& message,
                         CDRMessage_t& encoded, const Receivers& receivers) {
  if (receivers.empty()) return false;
  const Encode encode = library_encode();
  return encode != nullptr && encode(security_manager, message, encoded, receivers);
}

void guard_encoding() { (void)library_encode(); }

}  // namespace fieldcast

#endif
