#include "bridge/dds/library/encoding_guard.hpp"

#include <dlfcn.h>

#include <vector>

#include "bridge/dds/library/fastdds.hpp"

namespace fieldcast {
namespace {

using Receivers = std::vector<rtps::GuidPrefix_t>;
// Headers of the library declare neither the class nor, in 3.x, the message (CDRMessage_t).
using Encode = bool (*)(const void* security_manager, const void* message, void* encoded,
                        const Receivers& receivers);

// bool SecurityManager::encode_rtps_message(const CDRMessage_t&, CDRMessage_t&,
//                                           const std::vector<GuidPrefix_t>&) const
#if FASTDDS_VERSION_MAJOR >= 3
#define RTPS_NAMESPACE "_ZNK8eprosima7fastdds4rtps"
#else
#define RTPS_NAMESPACE "_ZNK8eprosima8fastrtps4rtps"
#endif
#define ENCODE_RTPS_MESSAGE                                                              \
  RTPS_NAMESPACE                                                                         \
  "8security15SecurityManager19encode_rtps_messageERKNS1_12CDRMessage_tERS4_RKSt6vector" \
  "INS1_12GuidPrefix_tESaIS9_EE"

Encode library_encode() {
  static const auto found = reinterpret_cast<Encode>(::dlsym(RTLD_NEXT, ENCODE_RTPS_MESSAGE));
  return found;
}

}  // namespace

// Returns false if the message was not encoded and is not sent.
[[gnu::visibility("default")]] bool encode_rtps_message(
    const void* security_manager, const void* message, void* encoded,
    const Receivers& receivers) __asm__(ENCODE_RTPS_MESSAGE);

bool encode_rtps_message(const void* security_manager, const void* message, void* encoded,
                         const Receivers& receivers) {
  if (receivers.empty()) return false;
  const Encode encode = library_encode();
  return encode != nullptr && encode(security_manager, message, encoded, receivers);
}

const char* encode_symbol() { return ENCODE_RTPS_MESSAGE; }

void guard_encoding() { (void)library_encode(); }

}  // namespace fieldcast
