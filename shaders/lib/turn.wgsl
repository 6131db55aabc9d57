
// The camera's rotation between two frames: motion holds the rows of prev_from_cur − 1, then the direction of motion.
// A ray is (x, y, 1) of the ideal pinhole.

// A ray of the current camera in the previous camera's frame.
fn turned(r: vec3f) -> vec3f {
    return r + vec3f(dot(motion[0].xyz, r), dot(motion[1].xyz, r), dot(motion[2].xyz, r));
}

// A ray of the previous camera in the current camera's frame.
fn turned_back(r: vec3f) -> vec3f {
    return r + r.x * motion[0].xyz + r.y * motion[1].xyz + r.z * motion[2].xyz;
}
