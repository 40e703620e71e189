#include "driver/error_watch.h"

namespace gradus {

ErrorWatch::ErrorWatch(Method &method, double aim) : method_(method), aim_(aim) { method_.pause_at(next_look()); }

bool ErrorWatch::is_reached() {
    if (method_.done_samples() < next_look())
        return false;
    method_.image();
    estimate_ = method_.statistics().estimated_error;
    next_ *= 2;
    method_.pause_at(next_look());
    return estimate_ && *estimate_ <= aim_; // NaN is not
}

} // namespace gradus
