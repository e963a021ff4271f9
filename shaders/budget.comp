#version 460
#extension GL_GOOGLE_include_directive : require
// Plan, between its steps, one invocation. With the marks counted: the dispatch over them. With the priorities
// counted: the threshold that fits the frame's budget, and the share of quads lit at that priority.
#include "lib/interface.glsl"

layout(local_size_x = 1) in;
layout(push_constant, scalar) uniform Constants { PlanPush push; };

// The pages that the frame before has given. When memory is new, those too that it only asked for: no tile then keeps
// a number that is given again.
void countSurfaces()
{
    bool emptied = push.surfaces.emptied != 0u;
    uint most = emptied ? ~0u : surfacesAFrame(push.surfaces.capacity);
    uint latest = push.plan.at.surfacesLatest + min(push.plan.at.surfacesBefore, most);
    push.plan.at.surfacesLatest = latest;
    if (emptied)
        push.plan.at.surfacesOldest = latest;
}

void main()
{
    if (push.plan.at.groups[0] == 0u) {
        uint marked = min(push.plan.at.marked, push.markCapacity);
        push.plan.at.marked = marked;
        uvec2 groups = groupRows(marked);
        push.plan.at.groups[0] = groups.x;
        push.plan.at.groups[1] = groups.y;
        return;
    }
    countSurfaces();
    uint always = push.plan.at.histogram[kPriorityAlways];
    uint budget = push.budgetQuads - min(always, push.budgetQuads);
    uint refreshable = uint(float(push.plan.at.quadsMarked) * push.refreshShare);
    push.plan.at.threshold = 0u;
    push.plan.at.share = 1.0;
    for (uint priority = kPriorityAlways; priority-- > 0u;) {
        uint count = push.plan.at.histogram[priority];
        uint affordable = priority < kPriorityChanged ? min(budget, refreshable) : budget;
        if (count > affordable) {
            push.plan.at.threshold = priority;
            push.plan.at.share = float(affordable) / float(count);
            break;
        }
        budget -= count;
        if (priority < kPriorityChanged)
            refreshable -= count;
    }
}
