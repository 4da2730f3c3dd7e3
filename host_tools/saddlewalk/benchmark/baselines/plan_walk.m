% The paper's plan in Matlab's language, as numpy_plan.py has it: a steady walk, Phase0 = 0, the
% left foot at x = 0, at one instant or a row of them. Tags: docs/equations.md.
1;

function row = plan_walk(speed, heel_strike, t)
    height = 1.79; mass = 63.3; d_h = 0.10; peak_speed = 3; g = 9.80665;
    pendulum = 0.57 * height;                                        % [E1]
    frequency = sqrt(g / pendulum);                                  % [E2]
    width = step_width(speed);
    half_step = 0.1802 * speed + 0.1351;                             % [E4]
    step_time = 2 * half_step / speed;

    [x, y, vx, vy] = com_path(speed, width, step_time, t);
    [left, right, stance] = feet(width, half_step, step_time, x, y, t);
    [leg, toe_off_now, heel_strike_now] = ankles(pendulum, d_h, speed, width, step_time, ...
                                                 heel_strike, t);
    z = sqrt(leg.^2 - (x - stance(1, :)).^2 - (y - stance(2, :)).^2); % [E14]

    shortest = speed / (2 * frequency);                              % [E6]
    longest = peak_speed / (2 * frequency);
    s_pend = (half_step - shortest) / (half_step - shortest);        % [E20]
    s_jump = (half_step - longest) / (half_step - longest);
    s_sw = 1 - 2 * abs(y - (left(2, :) + right(2, :)) / 2) / width;  % [E21]

    mos_com = margin(left, right, d_h, x, y);
    mos_xcom = margin(left, right, d_h, x + vx / frequency, y + vy / frequency); % [E19]

    dx = x - stance(1, :);
    dy = y - stance(2, :);
    surface = sqrt(pendulum^2 - dx.^2 - dy.^2);                      % [E18]
    gravity = mass * g * [dx ./ surface; dy ./ surface];

    same = ones(size(t));
    row = [x; y; z; vx; vy; left; right; leg; toe_off_now; heel_strike_now; ...
           s_pend * same; s_jump * same; s_sw; mos_com; mos_xcom; gravity];
end

function width = step_width(speed)                                   % [E3]
    if speed < 0.6
        width = 0.22;
    elseif speed > 1.1
        width = 0.10;
    else
        width = 0.3456 - 0.2128 * speed;
    end
end

function [x, y, vx, vy] = com_path(speed, width, step_time, t)       % [E7]
    amplitude = min(width / (2 * pi * speed), width / pi);
    rate = pi / step_time;
    x = speed * t;
    y = amplitude * cos(rate * t);
    vx = speed * ones(size(t));
    vy = -amplitude * rate * sin(rate * t);
end

function [left, right, stance] = feet(width, half_step, step_time, x, y, t) % [E8] [E9] [E10]
    steps = floor(t / step_time + 0.5);
    left_stands = mod(steps, 2) == 0;
    stance_x = steps * 2 * half_step;
    stance_y = width / 2 * (2 * left_stands - 1);
    swing_x = stance_x - 2 * stance_y .* (x - stance_x) ./ (y - stance_y);
    share = t / step_time + 0.5 - steps;
    s = 2 * min(share, 1 - share);
    swing_z = 0.05 * (10 * s.^3 - 15 * s.^4 + 6 * s.^5);
    side = width / 2 * ones(size(t));
    left = [stance_x .* left_stands + swing_x .* ~left_stands; side; swing_z .* ~left_stands];
    right = [stance_x .* ~left_stands + swing_x .* left_stands; -side; swing_z .* left_stands];
    stance = [stance_x; stance_y];
end

function [leg, toe_off_now, heel_strike_now] = ankles(pendulum, d_h, speed, width, step_time, ...
                                                      heel_strike, t) % [E11] [E12] [E13]
    until_strike = step_time / 2 - d_h * (1 - cos(heel_strike)) / speed;
    [x, y] = com_path(speed, width, step_time, until_strike);
    rise = pendulum - (0.02656 * speed + 0.002575);                  % [E5]
    longest = sqrt(rise^2 + x^2 + (y - width / 2)^2);
    toe_off = 2 * asin((longest - pendulum) / (2 * d_h));
    since = mod(t, step_time);
    progress = erf((since - until_strike) / 0.11);
    toe_off_now = toe_off * (1 + progress);
    heel_strike_now = heel_strike * (1 - progress);
    struck = since >= step_time / 2;
    leg = pendulum + 2 * d_h * sin((heel_strike_now .* struck + toe_off_now .* ~struck) / 2);
end

function d = margin(left, right, d_h, x, y)                          % [E15] [E16] [E17]
    across = left(1:2, :) - right(1:2, :);
    distance = hypot(across(1, :), across(2, :));
    across = across ./ distance;
    dx = x - (left(1, :) + right(1, :)) / 2;
    dy = y - (left(2, :) + right(2, :)) / 2;
    x_s = abs(dx .* across(2, :) - dy .* across(1, :));
    y_s = abs(dx .* across(1, :) + dy .* across(2, :));
    radius = distance / 2;
    from_origin = hypot(x_s, y_s);
    corner_y = sqrt(max(radius.^2 - d_h^2, 0));
    d = min(radius - from_origin, d_h - x_s);
    out = d < 0;
    arc = out & x_s .* radius <= d_h * from_origin;
    edge = out & ~arc & y_s <= corner_y;
    corner = out & ~arc & ~edge;
    d(arc) = radius(arc) - from_origin(arc);
    d(edge) = d_h - x_s(edge);
    d(corner) = -hypot(x_s(corner) - d_h, y_s(corner) - corner_y(corner));
end
