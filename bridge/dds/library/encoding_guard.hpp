// Prevents an abort of Fast DDS 2.9.1 with DDS Security that protects whole messages: the library
// asserts if it encodes a message without receivers (SecurityManager::encode_rtps_message). The
// thread that repeats samples releases their writer before it sends its last message
// (FlowControllerImpl::run), and the last reader may leave at that moment. A station that leaves
// could end the bridge. The linker resolves that function by name, so the definition here is used:
// it drops messages without receivers and passes all others on.
#pragma once

namespace fieldcast {

// Looks up the library's own function. Call it before the first participant; repeats do nothing.
void guard_encoding();

}  // namespace fieldcast
