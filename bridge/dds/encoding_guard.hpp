// With DDS Security that protects whole messages, Fast DDS 2.9.1 aborts when it is to encode one
// that nobody receives (an assertion in SecurityManager::encode_rtps_message). That comes about by
// itself: the thread that sends samples again lets go of their writer before it sends its last
// message (FlowControllerImpl::run), and the last reader may go in between. A station that leaves
// would take the bridge with it.
//
// The library finds that function by its name, as any other, so that the one of this program comes
// first. It sends nothing to nobody, and gives everything else to the library's own.
#pragma once

namespace fieldcast {

// Before the first participant: finds the library's own function. Any number of times.
void guard_encoding();

}  // namespace fieldcast
