#include "isochor/step/occt_wall.h"

// Without this the catching of signals compiles to nothing.
#ifndef OCC_CONVERT_SIGNALS
#define OCC_CONVERT_SIGNALS
#endif
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <Message_Printer.hxx>
#include <OSD.hxx>
#include <OSD_Signal.hxx>
#include <Standard_ErrorHandler.hxx>
#include <Standard_Failure.hxx>
#include <Standard_OutOfMemory.hxx>

namespace isochor::internal {
namespace {

std::string describe(const Standard_Failure& failure) {
  std::string text = failure.DynamicType()->Name();
  const char* more = failure.GetMessageString();
  if (more != nullptr && *more != '\0') text += std::string(": ") + more;
  return text;
}

OcctFault caught(const std::function<std::string()>& work) {
  try {
    OCC_CATCH_SIGNALS
    return {OcctFault::kNone, work()};
  } catch (const Standard_OutOfMemory& failure) {
    return {OcctFault::kOutOfMemory, describe(failure)};
  } catch (const OSD_Signal& failure) {
    return {OcctFault::kSignal, describe(failure)};
  } catch (const Standard_Failure& failure) {
    return {OcctFault::kFailure, "the CAD library failed: " + describe(failure)};
  }
}

}  // namespace

OcctFault behind_occt_wall(const std::function<std::string()>& work) {
  Message::DefaultMessenger()->RemovePrinters(STANDARD_TYPE(Message_Printer));
  OSD::SetSignal(false);
  return caught(work);
}

}  // namespace isochor::internal
