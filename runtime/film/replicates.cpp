#include "runtime/film/replicates.h"

#include <algorithm>

namespace gradus {

// With the shares w of the samples, the variances v of the replicates' means and V, the sum of w^2 v, of the whole: the
// squared distance d^2 of a replicate's mean from that of the whole is v (1 - 2 w) + V on average. So the sum of a d^2
// with a = w^2 / (1 - 2 w) is V (1 + the sum of a), whatever v are. Of equal shares it is the well-known sample
// variance over the number of replicates.
double variance_of_mean(std::span<const Replicate> replicates) {
    double sum = 0, count = 0, most = 0;
    int used = 0;
    for (const Replicate &replicate : replicates) {
        sum += replicate.sum;
        count += replicate.count;
        most = std::max(most, replicate.count);
        used += replicate.count > 0;
    }
    if (used < 2)
        return 0;
    const double mean = sum / count;
    const bool for_any = 2 * most < count;
    double squares = 0, parts = 0;
    for (const Replicate &replicate : replicates) {
        if (replicate.count <= 0)
            continue;
        const double apart = replicate.sum / replicate.count - mean, share = replicate.count / count;
        // Where samples are independent, d^2 over v is 1 - w on average, and v is their variance over their count.
        const double part = for_any ? share * share / (1 - 2 * share) : share;
        squares += part * apart * apart;
        parts += part;
    }
    return squares / (for_any ? 1 + parts : double(used - 1));
}

} // namespace gradus
